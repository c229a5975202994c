"""Joining modules: each once, in the order of dependence, private names apart, anything else refused."""

import re

import pytest

from workbench.views.esm import esm, join_modules
from workbench.views.theme import FRONTEND

ENTRY = re.compile(r"^export function (render\w+)", re.MULTILINE)
COMPONENTS = [
    (path.stem, match[1])
    for path in sorted(FRONTEND.glob("*.js"))
    if (match := ENTRY.search(path.read_text(encoding="utf-8")))
]


@pytest.fixture
def modules(tmp_path):
    def write(**texts):
        for name, text in texts.items():
            (tmp_path / f"{name}.js").write_text(text, encoding="utf-8")
        return tmp_path

    return write


def test_every_component_is_joined_without_relative_imports():
    assert {name for name, _ in COMPONENTS} >= {"mesh", "transport", "clock_pane", "lane", "shell"}
    for name, render in COMPONENTS:
        text = esm(name, render)
        assert not re.search(r"^\s*import\b", text, re.MULTILINE)
        assert re.findall(r"^export .*$", text, re.MULTILINE) == [text.rstrip().splitlines()[-1]]
        assert "globalThis[Symbol.for(" in text or "./clock.js" not in (FRONTEND / f"{name}.js").read_text()


def test_a_module_stands_once_and_before_those_that_need_it(modules):
    folder = modules(
        base="export const one = 1;\n",
        left='import { one } from "./base.js";\nexport const two = one + 1;\n',
        right='import { one as uno } from "./base.js";\nexport function three() { return uno + 2; }\n',
        top='import { two } from "./left.js";\nimport {\n  three,\n} from "./right.js";\n'
        "export function render() { return two + three(); }\n",
    )
    text = join_modules("top", "render", folder)
    places = [text.index(mark) for mark in ("one = 1", "two = one", "uno + 2", "two + three()")]
    assert places == sorted(places)
    assert text.count("one = 1") == 1


def test_private_names_of_two_modules_do_not_meet(modules):
    folder = modules(
        a="const size = 1;\nexport const a = size;\n",
        b='import { a } from "./a.js";\nconst size = 2;\nexport function render() { return a + size; }\n',
    )
    text = join_modules("b", "render", folder)
    assert not re.search(r"^const size", text.split("module_b")[0].split("(() => {")[0], re.MULTILINE)
    assert text.count("(() => {") == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('import three from "./x.js";\nexport function render() {}\n', "cannot be joined"),
        ('import { a } from "three";\nexport function render() {}\n', "only files beside it"),
        ("export default function render() {}\n", "cannot be joined"),
        ('import { render } from "./top.js";\nexport function draw() {}\n', "import one another"),
        ("export function draw() {}\n", "top.js does not export 'render'"),
    ],
)
def test_what_cannot_be_joined_is_refused(modules, text, words):
    with pytest.raises(ValueError, match=words):
        join_modules("top", "render", modules(top=text))


def test_a_name_that_is_not_exported_is_refused(modules):
    folder = modules(
        a="export const here = 1;\nconst there = 2;\n",
        top='import { here, there } from "./a.js";\nexport function render() { return here + there; }\n',
    )
    with pytest.raises(ValueError, match=r"a\.js does not export 'there', which top needs"):
        join_modules("top", "render", folder)


def test_a_missing_module_is_named(modules):
    with pytest.raises(FileNotFoundError, match=r"gone\.js"):
        join_modules(
            "top",
            "render",
            modules(top='import { a } from "./gone.js";\nexport function render() {}\n'),
        )
