"""What the tests of the commands share: a picture, and how a refusal looks."""

import pytest

from geoprim_core.cli.main import main
from geoprim_core.io.images import write_image
from geoprim_core.synthetic import disc_image


@pytest.fixture
def disc(tmp_path):
    """The file of an image of a disc at (70.25, 60.5) with radius 35.5."""
    path = tmp_path / "disc.png"
    write_image(path, disc_image(160, 120, centre=(70.25, 60.5), radius=35.5))
    return path


@pytest.fixture
def refused(capsys):
    """Run a command that has to end with code 2 and one line; return the line."""

    def run(*words):
        code = main([str(word) for word in words])
        (line,) = capsys.readouterr().err.splitlines()
        assert code == 2, line
        return line

    return run
