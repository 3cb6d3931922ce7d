"""A scene file of one plane under a constant sky."""
import pytest

from shell import SCENE


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path
