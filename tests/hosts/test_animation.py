"""Animations from the command line: frames depend on nothing but their number, stop and go on, and become a film."""
import os
import pathlib
import signal
import subprocess
import time

import pytest

HERE = pathlib.Path(__file__).resolve().parent
HOODOO = os.environ.get("HOODOO", str(HERE.parent.parent / "build/release/bin/hoodoo"))

SCENE = """version = 1
[film]
width = 48
height = 27
fps = 12
[render]
spp = 16
[camera]
shutter_angle = "180 deg"
[[camera.key]]
frame = 1
eye = [0, -20, 6]
target = [0, 0, 0]
[[camera.key]]
frame = 9
eye = [20, 0, 6]
target = [0, 0, 0]
fov = "30 deg"
[terrain.floor]
type = "plane"
point = [0, 0, "= 0.5 * t"]
[light.sky]
type = "sky"
elevation_deg = 30
"""


def hoodoo(*arguments, cwd=None):
    return subprocess.run([HOODOO, *map(str, arguments)], capture_output=True, text=True, timeout=300, cwd=cwd)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "wave.toml").write_text(SCENE)
    return tmp_path


def pixels(path):
    """The hash of all channels: equal hashes are equal bits."""
    text = subprocess.run(["oiiotool", "--hash", "-v", "--info", str(path)], capture_output=True, text=True, check=True).stdout
    return text.split("SHA-1:")[1].split()[0]


def render(folder, *arguments):
    result = hoodoo("render", "wave.toml", "--reproducible", *arguments, cwd=folder)
    assert result.returncode == 0, result.stderr
    return result.stderr


def test_a_frame_rendered_alone_is_the_same_file(folder):
    render(folder, "--frames", "1-5x2", "-o", "w.####.exr")
    assert sorted(p.name for p in folder.glob("*.exr")) == ["w.0001.exr", "w.0003.exr", "w.0005.exr"]
    render(folder, "--frame", 3, "-t", 2, "-o", "alone.exr")
    assert (folder / "alone.exr").read_bytes() == (folder / "w.0003.exr").read_bytes()
    # The comparison can fail: another frame is another picture, and so is another time of the scene alone.
    assert pixels(folder / "w.0001.exr") != pixels(folder / "w.0003.exr")


SEA = SCENE.replace("[terrain.floor]\ntype = \"plane\"\npoint = [0, 0, \"= 0.5 * t\"]", """[terrain.sea]
type = "breaking_wave"
extent = 200
time = 2
[[terrain.sea.wave]]
centre = [15, 0]""")
assert "breaking_wave" in SEA


def test_a_frame_of_a_breaking_wave_alone_is_the_frame_of_the_sequence(folder):
    (folder / "wave.toml").write_text(SEA)
    render(folder, "--frames", "15-19", "--spp", 4, "-o", "w.####.exr")
    render(folder, "--frame", 17, "-t", 2, "--spp", 4, "-o", "alone.exr")
    assert (folder / "alone.exr").read_bytes() == (folder / "w.0017.exr").read_bytes()
    assert pixels(folder / "w.0017.exr") != pixels(folder / "w.0018.exr")


def test_noise_differs_by_the_frame_unless_its_seed_is_locked(folder):
    text = SCENE.replace('"= 0.5 * t"', "0").replace("frame = 9\neye = [20, 0, 6]", "frame = 9\neye = [0, -20, 6]").replace('fov = "30 deg"', "")
    (folder / "wave.toml").write_text(text)
    render(folder, "--frames", "1,2", "-o", "free.#.exr")
    render(folder, "--frames", "1,2", "--lock-seed", "-o", "locked.#.exr")
    assert pixels(folder / "free.1.exr") != pixels(folder / "free.2.exr")
    assert pixels(folder / "locked.1.exr") == pixels(folder / "locked.2.exr")


@pytest.mark.parametrize("scene, spp", [(SCENE, 256), (SEA, 16)], ids=["plane", "sea"])
def test_a_killed_run_goes_on_to_the_same_files(folder, scene, spp):
    (folder / "wave.toml").write_text(scene)
    arguments = ["render", "wave.toml", "--reproducible", "--frames", "1-6", "--spp", spp, "-o", "w.#.exr", "-q"]
    assert hoodoo(*arguments, cwd=folder).returncode == 0
    whole = {p.name: p.read_bytes() for p in folder.glob("w.?.exr")}
    for number, code in ((signal.SIGKILL, -9), (signal.SIGTERM, 143)):
        for path in folder.glob("w.?.exr"):
            path.unlink()
        run = subprocess.Popen([HOODOO, *map(str, arguments), "--skip-existing"], cwd=folder, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 120
        while not (folder / "w.2.exr").exists() and time.monotonic() < deadline and run.poll() is None:
            time.sleep(0.002)
        run.send_signal(number)
        assert run.wait(60) == code
        assert not (folder / "w.6.exr").exists(), "it was stopped too late to show anything"
        assert hoodoo(*arguments, "--skip-existing", cwd=folder).returncode == 0
        assert {p.name: p.read_bytes() for p in folder.glob("w.?.exr")} == whole


def test_existing_files_are_kept_only_if_they_are_whole_and_of_the_same_picture(folder):
    render(folder, "--frames", "1-3", "-o", "w.#.exr", "-o", "w.#.png")
    whole = (folder / "w.2.exr").read_bytes()
    (folder / "w.2.exr").write_bytes(whole[: len(whole) // 2])
    said = render(folder, "--frames", "1-3", "--skip-existing", "-o", "w.#.exr", "-o", "w.#.png")
    assert said.count("are there already") == 2 and "wrote w.2.exr" in said
    assert (folder / "w.2.exr").read_bytes() == whole
    # A picture of other samples, and a PNG cut short, are not what is asked for.
    assert "there already" not in render(folder, "--frames", "1-3", "--skip-existing", "--spp", 17, "-o", "w.#.exr")
    png = (folder / "w.3.png").read_bytes()
    (folder / "w.3.png").write_bytes(png[: len(png) // 2])
    said = render(folder, "--frames", "1-3", "--skip-existing", "-o", "w.#.png")
    assert said.count("is there already") == 2 and "wrote w.3.png" in said


@pytest.mark.parametrize("arguments, message", [
    (["--frames", "1-b", "-o", "w.#.exr"], "this is no range of frames"),
    (["--frames", "1-2", "-o", "w.exr"], "all frames would have one name"),
    (["--frames", "1-2", "--frame", "3", "-o", "w.#.exr"], "excludes"),
])
def test_frames_that_cannot_be_are_refused(folder, arguments, message):
    result = hoodoo("render", "wave.toml", *arguments, cwd=folder)
    assert result.returncode == 2 and message in result.stderr + result.stdout
    assert not list(folder.glob("*.exr"))


def test_keys_out_of_order_are_named_with_their_place(folder):
    (folder / "wave.toml").write_text(SCENE.replace("frame = 9", "frame = 1"))
    result = hoodoo("check", "wave.toml", cwd=folder)
    assert result.returncode == 2
    assert "wave.toml:15:9: keys are out of order, expected a later frame than the key before" in result.stderr


def test_a_movie_has_every_frame_and_the_pictures_rate(folder):
    render(folder, "--frames", "1-5", "-o", "w.####.exr")
    result = hoodoo("movie", "w.####.exr", "-o", "w.mp4", cwd=folder)
    assert result.returncode == 0, result.stderr
    probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=width,height,r_frame_rate,nb_read_frames", "-of", "csv=p=0",
                            "w.mp4"], capture_output=True, text=True, check=True, cwd=folder).stdout.strip()
    assert probe == "48,26,12/1,5"  # an odd last row is cut
    assert not list(folder.glob("*.part"))
    (folder / "w.0003.exr").unlink()
    result = hoodoo("movie", "w.####.exr", "--frames", "1-5", "-o", "v.mp4", cwd=folder)
    assert result.returncode == 3 and "w.0003.exr" in result.stderr
    assert not (folder / "v.mp4").exists() and not list(folder.glob("*.part"))
