"""What the documents say of the tests is so: every test that they name is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NAMED = re.findall(
    r"`((?:ros|core|cli)/test_\w+\.py)(?:::(\w+))?`", (ROOT / "docs" / "habits.md").read_text()
)


def test_the_table_of_habits_names_tests():
    assert len(NAMED) > 20


@pytest.mark.parametrize(("file", "function"), NAMED, ids="::".join)
def test_a_named_test_exists(file, function):
    text = (ROOT / "test" / file).read_text()
    assert f"def {function}(" in text if function else "def test_" in text
