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


FOLDERS = (".", "docs", "bags", "benchmarks")
PAGES = sorted(page for folder in FOLDERS for page in (ROOT / folder).glob("*.md"))
LINKS = [
    (str(page.relative_to(ROOT)), link)
    for page in PAGES
    for link in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text())
    if "://" not in link
]


@pytest.mark.parametrize(("page", "link"), LINKS, ids=" -> ".join)
def test_a_link_leads_to_a_file(page, link):
    assert (ROOT / page).parent.joinpath(link).exists()


def test_every_page_is_linked_from_another():
    linked = {(ROOT / page).parent.joinpath(link).resolve() for page, link in LINKS}
    assert [page.name for page in PAGES if page not in linked and page.parent != ROOT] == []
