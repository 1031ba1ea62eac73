"""A picture's words, in each place where somebody looks for them."""

import base64

from my_robot_basics.drawing.described import described

PNG = b'\x89PNG and so on'


def test_the_words_stand_beside_the_pixels_and_in_the_metadata():
    bundle, metadata = described(PNG, 'an arm')
    source = base64.b64encode(PNG).decode()
    assert bundle == {
        'image/png': PNG,
        'text/html': f'<img alt="an arm" src="data:image/png;base64,{source}">',
        'text/plain': 'an arm',
    }
    assert metadata == {'image/png': {'alt': 'an arm'}}


def test_words_of_several_lines_become_one_and_nothing_in_them_is_markup():
    bundle, metadata = described(PNG, 'saw "1"\nand <b>2</b>')
    assert metadata['image/png']['alt'] == 'saw "1"; and <b>2</b>'
    assert 'alt="saw &quot;1&quot;; and &lt;b&gt;2&lt;/b&gt;"' in bundle['text/html']
    assert bundle['text/plain'].splitlines() == ['saw "1"', 'and <b>2</b>']
