"""Lines of a log about IK: the numbers in them, and which of them hold angles."""

import pytest
from my_robot_basics.checks.values import answers


@pytest.mark.parametrize(
    ('text', 'numbers'),
    [
        ('up 1.5°, down -2', [1.5, -2.0]),
        ('−3.25 and +4e1', [-3.25, 40.0]),
        ('elbow = ±76.26°', [76.26, -76.26]),
        ('elbow = +/-76.26 or +/−1.5', [76.26, -76.26, 1.5, -1.5]),
        ('elbow = ∓76.26°, -/+1.5', [-76.26, 76.26, -1.5, 1.5]),
        ('+65.92/-74.04; 1.46-74.04', [65.92, -74.04, 1.46, -74.04]),
        ('none', []),
    ],
)
def test_numbers_are_read_as_people_write_them(text, numbers):
    assert answers.numbers_of(text) == numbers


@pytest.mark.parametrize(
    ('text', 'advice'),
    [
        ('θ1=nan', 'nan'),
        ('{branch}: {a:.2f} {b:.2f}', 'put an f before'),
        ('elbow_up: 65,92 / -74,04', 'decimals with a point'),
        ('(65,92) / -74,0', ''),
        ('theta1-65.92, theta2--74.04', 'a - right before a number is its sign'),
        ('theta1-65.9, theta2--74.04', ''),
        ("{'elbow_up': (6.5, -7.4)}", ''),
        ('{"elbow_up": [6.5, -7.4]}', ''),
        ('elbow_up, elbow_down', 'returns a dict'),
        ('no solution', ''),
        ('', ''),
    ],
)
def test_a_number_that_cannot_be_read_gets_advice(text, advice):
    found = answers.why_unreadable([65.92, -74.04], [text])
    assert advice in found
    assert bool(found) == bool(advice)


@pytest.mark.parametrize(
    ('text', 'is_stretched'),
    [
        ('θ1=61.15°, θ2=0.00°', True),
        ('θ1=61.15°, θ2=-180.00°', True),
        ('[0.0, 61.15]', True),
        ('target at 3.000 m, bearing 61.15°', False),
        ('bearing 61.15°, 0 solutions', False),
        ('bearing 62.15°, θ2=0.00°', False),
    ],
)
def test_a_bearing_is_an_answer_only_with_the_elbow_of_a_stretched_arm(text, is_stretched):
    assert answers.has_stretched([61.15], text) is is_stretched


def test_a_form_that_answers_share_with_other_lines_decides_nothing():
    forms = answers.Forms()
    forms.learn([65.92, -74.04], ['up 65.92 -74.04', 'distance 1.44', '1.44', '65.92'])
    assert forms.is_answer('up 1.5 2.5')
    assert not forms.is_other('up 1.5 2.5')
    assert forms.is_other('distance 3')
    assert not forms.is_answer('distance 3')
    assert not forms.is_answer('1.5')
    assert not forms.is_other('1.5')


@pytest.mark.parametrize(
    ('text', 'stands_for_them'),
    [
        ('none: 0.00 0.00', True),
        ('θ1=-0.00°, θ2=0.0°', True),
        ('moved by 0.00 m', False),
        ('0 of 0 reached', False),
        ('(0.00, 3.00) is too far', False),
    ],
)
def test_a_pair_of_decimal_zeros_counts_as_angles(text, stands_for_them):
    assert answers.stands_for_angles([], text) is stands_for_them


@pytest.mark.parametrize(
    ('texts', 'are_branches'),
    [
        (['near: 47.46 -5.17 or 42.54 5.17'], True),
        (["{'elbow_up': (407.46, -5.17), 'elbow_down': (42.54, 5.17)}"], True),
        (['up 47.46 −5.17', 'down 42.54 5.17'], True),
        (['up 48.46 -5.17', 'down 42.54 5.17'], False),
        (['up 47.46 -5.17'], False),
        (['bearing 45.00, from 0.20 m to 1.80 m'], False),
        (['within -1.80 and 1.80 m of 45.00'], False),
        (['45 1', '45 -1'], False),
    ],
)
def test_both_branches_of_a_point_mirror_each_other_in_its_bearing(texts, are_branches):
    assert answers.hold_both_branches([45.0, 225.0], texts) is are_branches


def test_a_flood_of_numbers_is_compared_up_to_a_limit_of_pairs(monkeypatch):
    compared = []

    def combinations(pairs, _):
        compared.append(len(pairs))
        return ()

    monkeypatch.setattr(answers.itertools, 'combinations', combinations)
    texts = [f'{number}.5 1.5' for number in range(5_000)]
    assert not answers.hold_both_branches([0.0], texts)
    assert compared == [answers.MOST_PAIRS]
