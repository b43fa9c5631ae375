"""Strict YAML: what is refused, with which words and where; and what scalars mean."""

import random
from pathlib import Path
from typing import Any

import pytest
import yaml

from limbik.core import yamlfile
from limbik.core.errors import SceneError
from limbik.core.yamlfile import read_yaml, read_yaml_file

SCENE = """\
version: 1
limbs:
  - name: arm
    strategy: two-bone
    bones:
      - {name: upper, length: 0.3}
      - {name: lower, length: 0.25}
targets:
  - {limb: arm, position: [0.1, 0.2, 0.3]}
"""


def changed(old: str, new: str) -> str:
    assert SCENE.count(old) == 1
    return SCENE.replace(old, new)


def length(text: str) -> str:
    return changed("length: 0.3", f"length: {text}")


BOMB = "a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\nd: [*c, *c]\n"
BONE = "limbs[0].bones[0]"
BAD: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "1:1: error[empty]: the file is empty"),
    "only comments": ("# a\n# b\n", "1:1: error[empty]: the file is empty"),
    "two documents": (
        SCENE + "---\na: 1\n",
        "10:1: error[multi-doc]: a second document starts here; a file holds one",
    ),
    "tab indentation": (
        changed("    strategy", "\tstrategy"),
        "4:1: error[syntax]: a tab cannot indent; use spaces",
    ),
    "bad indentation": (
        changed("    bones:", "   bones:"),
        "5:4: error[syntax]: this line is indented differently from its neighbours",
    ),
    "unclosed bracket": (
        changed("0.3]}", "0.3}"),
        "9:41: error[syntax]: expected ',' or ']'",
    ),
    "unclosed quote": (
        changed("[0.1, 0.2, 0.3]", "'abc"),
        "10:1: error[syntax]: the file ends inside a quoted text (it began at line 9, column 27)",
    ),
    "quote across a document": (
        "a: 'x\n---\nb'\n",
        "2:1: error[syntax]: a line '---' or '...' inside a quoted text",
    ),
    "missing colon": (
        changed("    bones:", "    bones"),
        "6:14: error[syntax]: a ':' is missing after the key",
    ),
    "colon in plain text": (
        changed("name: arm", "name: arm: b"),
        "3:14: error[syntax]: no ':' may stand here",
    ),
    "missing value": ("a: [1,, 2]\n", "1:7: error[syntax]: a value is missing here"),
    "reserved character": (
        "a: @x\n",
        "1:4: error[syntax]: this character cannot start a value; put the text in quotes",
    ),
    "bare asterisk": (
        "a: * b\n",
        "1:5: error[syntax]: '&' and '*' start anchors and aliases, which are not allowed",
    ),
    "latin-1": (
        "a: 1\nname: café\n".encode("latin-1"),
        "2:10: error[encoding]: the byte 0xe9 is not UTF-8 (save the file as UTF-8)",
    ),
    "bad byte after wide characters": (
        "é: 1\r\n日本: ".encode() + b"\xff",
        "2:5: error[encoding]: the byte 0xff is not UTF-8",
    ),
    "UTF-16": (SCENE.encode("utf-16"), "1:1: error[encoding]: the file is UTF-16"),
    "NUL": (changed("arm\n", "a\0m\n"), "3:12: error[encoding]: the character U+0000 is not"),
    "bell": (changed("arm\n", "a\am\n"), "3:12: error[encoding]: the character U+0007 is not"),
    "line separator": ("a: b\u2028c\n", "1:5: error[encoding]: the character U+2028 is not"),
    "half a surrogate": ("a: \ud800\n", "1:4: error[encoding]: the character U+D800 is not"),
    "escaped NUL": ('a: "\\0"\n', "1:4: error[encoding]: a: the character U+0000 is not allowed"),
    "duplicate key": (
        "version: 1\n" + SCENE,
        "2:1: error[duplicate]: version: key 'version' is given twice, first at line 1, column 1",
    ),
    "duplicate key in a bone": (
        changed("length: 0.3}", "length: 0.3, length: 0.4}"),
        f"6:36: error[duplicate]: {BONE}.length: key 'length' is given twice, "
        "first at line 6, column 23",
    ),
    "anchor": (
        changed("{name: upper", "&b {name: upper"),
        f"6:9: error[alias]: {BONE}: anchors and aliases are not allowed: &b",
    ),
    "merge key": (
        changed("{name: upper", "{<<: {a: 1}, name: upper"),
        f"6:10: error[alias]: {BONE}: merge keys are not allowed",
    ),
    "undefined alias": (
        changed("name: arm", "name: *foo"),
        "3:11: error[alias]: limbs[0].name: anchors and aliases are not allowed: *foo",
    ),
    "recursive alias": ("version: 1\nlimbs: &a [*a]\n", "2:8: error[alias]: limbs: anchors"),
    "alias bomb": (BOMB, "1:4: error[alias]: a: anchors and aliases are not allowed: &a"),
    "alias as a key": ("*a : 1\n", "1:1: error[alias]: anchors and aliases are not allowed: *a"),
    "python tag": (
        changed("name: arm", "name: !!python/object/apply:os.system [ls]"),
        "3:11: error[tag]: limbs[0].name: tags are not allowed: "
        "tag:yaml.org,2002:python/object/apply:os.system",
    ),
    "custom tag": (length("!mm 3"), f"6:31: error[tag]: {BONE}.length: tags are not allowed: !mm"),
    "core tag": (length("!!float 3"), "6:31: error[tag]: "),
    "depth 10 000": ("[" * 10_000, "1:21: error[too-deep]: nested deeper than 20"),
    "depth of mappings": (
        "".join(f"{' ' * n}a:\n" for n in range(30)),
        "21:21: error[too-deep]: nested deeper than 20",
    ),
    "2 MB": ("#" * 2_000_189, "1:1: error[too-large]: the file has 2000189 bytes, the limit is"),
    "nan": (length(".nan"), f"6:31: error[not-finite]: {BONE}.length: .nan is not a finite number"),
    "inf": (length("-.Inf"), f"6:31: error[not-finite]: {BONE}.length: -.Inf is not a finite"),
    "1e999": (length("1e999"), f"6:31: error[number]: {BONE}.length: the number is too large"),
    "1e-999": (length("1e-999"), f"6:31: error[number]: {BONE}.length: the number is too small"),
    "400 digits": (
        length("9" * 400),
        f"6:31: error[number]: {BONE}.length: the number is too large: 999999999999...",
    ),
    "5000 digits": (length("9" * 5000), "6:31: error[number]: "),
    "2^63": (length(str(2**63)), "6:31: error[number]: "),
    "number as a key": ("1: x\n", "1:1: error[key]: a key must be text; write it in quotes: '1'"),
    "truth as a key": ("a:\n  true: x\n", "2:3: error[key]: a: a key must be text"),
    "empty key": ("'': x\n", "1:1: error[key]: a key must be text; it is empty"),
    "list as a key": ("? [a]\n: b\n", "1:3: error[key]: a key must be text, not a list"),
}


@pytest.fixture(params=["C", "Python"])
def parser(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Both parsers of PyYAML, since not every build has the faster one."""
    if request.param == "Python":
        monkeypatch.setattr(yamlfile, "_LOADER", yaml.SafeLoader)
    elif not yaml.__with_libyaml__:
        pytest.skip("this PyYAML has no C parser")
    return str(request.param)


def refused(source: str | bytes) -> list[str]:
    with pytest.raises(SceneError) as caught:
        read_yaml(source, "s.yaml")
    return str(caught.value).splitlines()


@pytest.mark.parametrize("case", BAD)
def test_a_fault_is_named_at_its_place_by_either_parser(case: str, parser: str) -> None:
    source, expected = BAD[case]
    first = refused(source)[0]
    assert first.startswith(f"s.yaml:{expected}")


def test_a_file_of_too_many_values_is_refused_where_it_passes_the_limit() -> None:
    (line,) = refused("[" + "0," * 200_000 + "]")
    assert line == "s.yaml:1:200000: error[too-many]: more than 100000 values and keys"


def test_an_unknown_escape_is_refused_with_the_way_out(parser: str) -> None:
    (line,) = refused('a: "C:\\qux"\n')
    assert line.endswith(": unknown escape; write '\\\\' for a backslash in double quotes")


def test_all_faults_of_a_file_are_reported_at_once() -> None:
    text = "a: .nan\nb: &x 1\nc: 1e999\na: 2\nd: [\n"
    assert [line.split(": ")[1] for line in refused(text)] == [
        "error[not-finite]",
        "error[alias]",
        "error[number]",
        "error[duplicate]",
        "error[syntax]",
    ]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        ("-12", -12),
        ("+7", 7),
        ("010", 10),
        ("0.5", 0.5),
        (".5", 0.5),
        ("2.", 2.0),
        ("1e-3", 1e-3),
        ("-1.5E+2", -150.0),
        ("-0.0", -0.0),
        ("0e5", 0.0),
        ("true", True),
        ("false", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("yes", "yes"),
        ("no", "no"),
        ("on", "on"),
        ("off", "off"),
        ("True", "True"),
        ("0x10", "0x10"),
        ("0o17", "0o17"),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2026-01-01", "2026-01-01"),
        ("=", "="),
        ("1.2.3", "1.2.3"),
        ("nan", "nan"),
        ("e5", "e5"),
        ("١٢", "١٢"),
        ("'1'", "1"),
        ('"true"', "true"),
        ("''", ""),
    ],
)
def test_a_scalar_means_what_yaml_1_2_says(text: str, value: Any, parser: str) -> None:
    found = read_yaml(f"a: {text}", "s.yaml").content["a"]
    assert (type(found), repr(found)) == (type(value), repr(value))


def test_a_scene_is_read_as_plain_values(parser: str) -> None:
    assert read_yaml(SCENE, "s.yaml").content == {
        "version": 1,
        "limbs": [
            {
                "name": "arm",
                "strategy": "two-bone",
                "bones": [
                    {"name": "upper", "length": 0.3},
                    {"name": "lower", "length": 0.25},
                ],
            }
        ],
        "targets": [{"limb": "arm", "position": [0.1, 0.2, 0.3]}],
    }


@pytest.mark.parametrize(
    ("path", "value", "key"),
    [
        ((), (1, 1), (1, 1)),
        (("version",), (1, 10), (1, 1)),
        (("limbs",), (3, 3), (2, 1)),
        (("limbs", 0), (3, 5), (3, 5)),
        (("limbs", 0, "bones", 1, "length"), (7, 31), (7, 23)),
        (("targets", 0, "position", 2), (9, 38), (9, 38)),
        (("targets", 0, "position", 7), (9, 27), (9, 27)),
        (("limbs", 0, "bones", 1, "color", "red"), (7, 9), (7, 9)),
        (("elsewhere",), (1, 1), (1, 1)),
    ],
)
def test_every_value_and_key_knows_its_place(
    path: tuple[str | int, ...], value: tuple[int, int], key: tuple[int, int], parser: str
) -> None:
    document = read_yaml(SCENE, "s.yaml")
    assert document.position(path) == value
    assert document.key_position(path) == key


def test_columns_count_characters_not_bytes(parser: str) -> None:
    document = read_yaml("é: [日本, 😀, x]\n", "s.yaml")
    assert document.position(("é", 2)) == (1, 12)


@pytest.mark.parametrize("line_break", ["\n", "\r\n", "\r"])
def test_lines_are_counted_with_every_line_break(line_break: str, parser: str) -> None:
    document = read_yaml(f"a: 1{line_break}{line_break}b: 2", "s.yaml")
    assert document.content == {"a": 1, "b": 2}
    assert document.position(("b",)) == (3, 4)


@pytest.mark.parametrize("source", ["\ufeffa: 1\n", b"\xef\xbb\xbfa: 1\n"])
def test_a_byte_order_mark_is_no_fault_and_no_column(source: str | bytes, parser: str) -> None:
    document = read_yaml(source, "s.yaml")
    assert document.content == {"a": 1}
    assert document.position(("a",)) == (1, 4)


@pytest.mark.parametrize(("text", "content"), [("---\n", None), ("- a\n", ["a"]), ("x\n", "x")])
def test_what_the_content_should_be_is_left_to_the_caller(text: str, content: object) -> None:
    assert read_yaml(text, "s.yaml").content == content


def test_a_document_makes_faults_at_values_and_keys() -> None:
    document = read_yaml(SCENE, "s.yaml")
    path = ("limbs", 0, "strategy")
    assert str(document.fault("c", "m", path)) == "s.yaml:4:15: error[c]: limbs[0].strategy: m"
    assert document.fault("c", "m", path, at_key=True).column == 5


def test_the_limits_themselves_are_allowed() -> None:
    assert read_yaml("[" * 20 + "]" * 20, "s.yaml").content
    assert len(read_yaml("[" + "0," * 99_999 + "]", "s.yaml").content) == 99_999
    assert read_yaml("a: 1\n" + "#" * (1_000_000 - 5), "s.yaml").content == {"a": 1}


def test_an_alias_bomb_is_refused_before_anything_is_built_from_it(parser: str) -> None:
    """Nine levels of nine would be 400 million values."""
    levels = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    levels += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 9)]
    assert (
        refused("\n".join(levels))[-1] == "s.yaml:3:40: error[more]: 62 more faults are not shown"
    )


def test_a_file_is_read_by_its_name(tmp_path: Path) -> None:
    path = tmp_path / "arm.yaml"
    path.write_text(SCENE, encoding="utf-8")
    document = read_yaml_file(path)
    assert document.name == str(path)
    assert document.content["version"] == 1


def test_a_file_that_cannot_be_read_is_a_fault(tmp_path: Path) -> None:
    for path in (tmp_path / "absent.yaml", tmp_path):
        with pytest.raises(SceneError, match=r"error\[unreadable\]: cannot read the file: "):
            read_yaml_file(path)


def test_a_large_file_is_refused_with_its_size_and_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    with path.open("wb") as stream:
        stream.truncate(10_000_000_000)
    with pytest.raises(SceneError, match="the file has 10000000000 bytes"):
        read_yaml_file(path)


def mutated(chance: random.Random, source: bytes) -> bytes:
    """Change a few bytes: replace, insert, delete, repeat a piece, cut the end."""
    text = bytearray(source)
    pieces = [
        b"&a ",
        b"*a",
        b"!!x ",
        b"---\n",
        b"<<: ",
        b"\t",
        b"\xff",
        b"{",
        b"]",
        b": ",
        b"- ",
        b"'",
        b'"\\',
        b"|\n",
        b"%",
        b"\0",
        b"\xe2\x80\xa8",
        b"? ",
        b"1e999",
        b".nan",
        b"\r",
    ]
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(text) + 1)
        match chance.randrange(5):
            case 0:
                text[at : at + 1] = bytes([chance.randrange(256)])
            case 1:
                text[at:at] = chance.choice(pieces)
            case 2:
                del text[at : at + chance.randint(1, 8)]
            case 3:
                text[at:at] = text[at : at + chance.randint(1, 30)]
            case _:
                del text[max(at, len(text) - 20) :]
    return bytes(text)


def test_mutated_scenes_are_read_or_refused_with_a_place() -> None:
    """2000 scenes with a few bytes changed: a content or a located fault, nothing else."""
    chance = random.Random(20)
    refusals: list[tuple[bytes, SceneError]] = []
    for _ in range(2000):
        source = mutated(chance, SCENE.encode())
        try:
            read_yaml(source, "s.yaml")
        except SceneError as error:
            refusals.append((source, error))
    for source, refusal in refusals:
        last = source.count(b"\n") + source.count(b"\r") + 2
        assert all(0 < f.line <= last and f.column > 0 for f in refusal.faults), source
    assert 200 < len(refusals) < 1800
