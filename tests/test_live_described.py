"""The description of a picture is in each place where a reader or a program looks for it."""

import base64

from my_robot_basics.drawing.described import png_output

PNG = b'\x89PNG and so on'


def test_a_description_is_beside_the_pixels_and_in_the_metadata():
    bundle, metadata = png_output(PNG, 'an arm')
    source = base64.b64encode(PNG).decode()
    assert bundle == {
        'image/png': PNG,
        'text/html': f'<img alt="an arm" src="data:image/png;base64,{source}">',
        'text/plain': 'an arm',
    }
    assert metadata == {'image/png': {'alt': 'an arm'}}


def test_a_description_of_several_lines_is_joined_and_its_markup_is_escaped():
    bundle, metadata = png_output(PNG, 'saw "1"\nand <b>2</b>')
    assert metadata['image/png']['alt'] == 'saw "1"; and <b>2</b>'
    assert 'alt="saw &quot;1&quot;; and &lt;b&gt;2&lt;/b&gt;"' in bundle['text/html']
    assert bundle['text/plain'].splitlines() == ['saw "1"', 'and <b>2</b>']
