"""The JSON Schema that editors use: every scene passes it, and it refuses what the reader refuses."""
import json
import re
import tomllib

import jsonschema
import pytest

from test_cli import ROOT, SCENE, hoodoo


@pytest.fixture(scope="module")
def validator():
    schema = json.loads(hoodoo("schema").stdout)
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def all_scenes():
    return sorted([*(ROOT / "scenes").rglob("*.toml"), *(ROOT / "tests/images").rglob("scene.toml")])


def merged(path):
    """A scene with what it includes, by the reader's rule: tables merge, all else of the including file wins."""
    def merge(base, over):
        both = isinstance(base, dict) and isinstance(over, dict)
        return {**base, **{k: merge(base[k], v) if k in base else v for k, v in over.items()}} if both else over

    scene = tomllib.loads(path.read_text())
    base = {}
    for included in scene.pop("include", []):
        base = merge(base, merged(path.parent / included))
    return merge(base, scene)


@pytest.mark.parametrize("path", all_scenes(), ids=[str(p.relative_to(ROOT)) for p in all_scenes()])
def test_every_scene_is_valid_for_editors_and_names_its_schema(path, validator):
    text = path.read_text()
    errors = [f"{'/'.join(map(str, e.absolute_path))}: {e.message[:200]}" for e in validator.iter_errors(merged(path))]
    assert errors == []
    if path.is_relative_to(ROOT / "scenes"):
        header = re.match(r"#:schema (\S+)\n", text)
        assert header, "the first line is `#:schema PATH`"
        assert (path.parent / header.group(1)).resolve() == ROOT / "build/hoodoo.schema.json"


def test_the_editors_schema_knows_units_expressions_and_parameters(validator):
    assert list(validator.iter_errors(tomllib.loads(SCENE))) == []
    more = SCENE.replace("type = \"plane\"", "type = \"plane\"\npoint = [\"10 m\", \"-1.5e1 km\", \"= 2 * height\"]\nseed = 3")
    more = more.replace("[film]", "hfov_deg = \"= 10 + 3\"\n[film]").replace("spp = 4", "spp = \"${height}\"")
    assert list(validator.iter_errors(tomllib.loads(more))) == []


@pytest.mark.parametrize("old, new", [("width = 64", "widht = 64"), ("width = 64", "width = 0"), ("width = 64", 'width = "64"'), ("version = 1", "version = 2"),
                                      ('"plane"', '"plain"'), ("grey = 0.5", "gray = 0.5"), ("[film]", "hfov = 40\n[film]"), ("[film]", 'hfov = "40 m"\n[film]'),
                                      ("target = [0, 0, 0]", "target = [0, 0]"), ("target = [0, 0, 0]\n", "")])
def test_the_editors_schema_and_the_reader_refuse_the_same(validator, tmp_path, old, new):
    text = SCENE.replace(old, new)
    assert text != SCENE
    assert list(validator.iter_errors(tomllib.loads(text)))
    path = tmp_path / "scene.toml"
    path.write_text(text)
    assert hoodoo("check", path).returncode == 2


def test_schema_explains_one_section():
    result = hoodoo("schema", "film")
    assert result.returncode == 0 and "width" in result.stdout and "Default 1024" in result.stdout
    assert hoodoo("schema", "flim").returncode == 2
