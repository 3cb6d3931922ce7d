"""Pictures of the command line, read by programs that share no code with it: exrheader and oiiotool."""
import os
import pathlib
import re
import shutil
import subprocess

import pytest

HOODOO = os.environ.get("HOODOO", "build/release/bin/hoodoo")
SCENE = pathlib.Path(__file__).resolve().parent.parent / "images/arch/scene.toml"

pytestmark = pytest.mark.skipif(not (shutil.which("exrheader") and shutil.which("oiiotool")), reason="needs the packages openexr and openimageio-tools")


def run(*command, **environment):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env={**os.environ, **environment}, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def render(output, *more, **environment):
    run(HOODOO, "render", SCENE, "--quiet", "-o", output, "-r", "48", "27", "--spp", "16", *more, **environment)
    return output


@pytest.fixture(scope="module")
def picture(tmp_path_factory):
    return render(tmp_path_factory.mktemp("pictures") / "a.exr")


def pixel_hash(path):
    """SHA-1 of the pixels, whatever the header says."""
    return re.search(r"SHA-1: ([0-9A-F]{40})", run("oiiotool", "--hash", path)).group(1)


def channel_list(path):
    found = re.search(r"channel list: (.*)", run("oiiotool", "--info", "-v", path)).group(1)
    return [entry.split()[0] for entry in found.split(",")]


def statistics(path):
    """{channel: {"Min": ..., "NanCount": ...}}"""
    names = channel_list(path)
    table = {name: {} for name in names}
    for key, values in re.findall(r"Stats (\w+): ((?:[-+.\w]+ ?)+)", run("oiiotool", "--stats", path)):
        for name, value in zip(names, values.split()):
            table[name][key] = float(value)
    return table


def test_all_channels_are_there_in_their_formats(picture):
    header = run("exrheader", picture)
    half = "R G B A N.X N.Y N.Z Ng.X Ng.Y Ng.Z albedo.R albedo.G albedo.B material.sand material.bedrock".split()
    full = "Z P.X P.Y P.Z motion.X motion.Y objectId instanceId variance.R variance.G variance.B samples.Y cost.Y".split()
    for name in half:
        assert f"    {name}, 16-bit floating-point" in header
    for name in full:
        assert f"    {name}, 32-bit floating-point" in header
    assert header.count("file format version") == 1 and "part " not in header
    assert "compression (type compression): zip" in header


def test_the_header_tells_where_the_picture_comes_from(picture):
    header = run("exrheader", picture)
    for line in (
        "white (0.32168 0.33767)",
        'colorInteropID (type string): "lin_ap1_scene"',
        "worldToCamera (type m44f)",
        "worldToNDC (type m44f)",
        'Software (type string): "Hoodoo ',
        'hoodoo:seed (type string): "',
        "hoodoo:spp (type int): 16",
        "hoodoo:renderTime (type float): ",
        "hoodoo:memory (type float): ",
        "hoodoo:sceneHash (type string): ",
        "hoodoo:processor (type string): ",
        "hoodoo:instructionSet (type string): ",
        'hoodoo:libraries (type string): "Embree ',
        'capDate (type string): "1970:01:01 00:00:00"',
        "red   (0.713 0.293)",
    ):
        assert line in header, line


def test_the_header_tells_no_path(picture):
    content = picture.read_bytes()[:20000]
    assert b"hoodoo:sceneHash" in content
    for secret in (str(SCENE), str(SCENE.parent), SCENE.name, str(picture), picture.name):
        assert secret.encode() not in content, secret


def test_the_numbers_are_sane(picture):
    table = statistics(picture)
    for name, values in table.items():
        assert values["NanCount"] == 0, name
        assert values["InfCount"] == 0 or name == "Z", name
        if name not in ("N.X", "N.Y", "N.Z", "Ng.X", "Ng.Y", "Ng.Z", "P.X", "P.Y", "P.Z"):
            assert values["Min"] >= 0, name
    assert table["samples.Y"]["Min"] == table["samples.Y"]["Max"] == 16
    assert table["objectId"]["Max"] == 1 and table["objectId"]["Min"] == 0
    assert table["A"]["Max"] == 1
    assert table["R"]["Max"] > 10 and table["variance.R"]["Max"] > 0 and table["cost.Y"]["Avg"] > 1


def test_materials_share_every_covered_pixel(picture):
    names = channel_list(picture)
    materials = [name for name in names if name.startswith("material.")]
    covered = 0
    for line in run("oiiotool", "--dumpdata", picture).splitlines():
        found = re.match(r"\s*Pixel \(\d+, \d+\):((?: [-+.\w]+)+)", line)
        if found:
            pixel = dict(zip(names, map(float, found.group(1).split())))
            if pixel["A"] == 1:
                covered += 1
                # Each share was rounded to a half: up to 2^-12 of error apiece.
                assert abs(sum(pixel[name] for name in materials) - 1) < 2e-3
    assert covered > 500


def test_nobody_and_nothing_changes_the_pixels(picture, tmp_path):
    wanted = pixel_hash(picture)
    assert pixel_hash(render(tmp_path / "again.exr")) == wanted
    for threads in (1, 3):
        assert pixel_hash(render(tmp_path / "threads.exr", "-t", threads)) == wanted
    assert pixel_hash(render(tmp_path / "seed.exr", "--seed", 5)) != wanted


def light_hash(path):
    """Of all channels but the cost: how many cells a ray visits depends on the width of Embree's tree, which is the one thing that may."""
    light = path.with_suffix(".light.exr")
    run("oiiotool", path, "--ch", ",".join(name for name in channel_list(path) if name != "cost.Y"), "-o", light)
    return pixel_hash(light)


@pytest.mark.parametrize("isa", ["sse4", "avx2", "avx512"])
def test_every_instruction_set_gives_the_same_light(picture, tmp_path, isa):
    probe = subprocess.run([HOODOO, "version"], capture_output=True, text=True, env={**os.environ, "HOODOO_ISA": isa}, timeout=60)
    if probe.returncode != 0:
        assert f"HOODOO_ISA={isa}" in probe.stderr
        pytest.skip(probe.stderr.strip())
    forced = render(tmp_path / "forced.exr", HOODOO_ISA=isa)
    assert f'hoodoo:instructionSet (type string): "{isa}"' in run("exrheader", forced)
    assert light_hash(forced) == light_hash(picture)


def test_a_crop_is_a_part_of_the_picture(picture, tmp_path):
    crop = render(tmp_path / "crop.exr", "--pixel-bounds", "13,30,5,22")
    header = run("exrheader", crop)
    assert "dataWindow (type box2i): (13 5) - (29 21)" in header and "displayWindow (type box2i): (0 0) - (47 26)" in header
    pixels = {line for line in run("oiiotool", "--dumpdata", crop).splitlines() if "Pixel" in line}
    assert len(pixels) == 17 * 17
    assert pixels <= set(run("oiiotool", "--dumpdata", picture).splitlines())


def test_replicates_are_named_and_their_variance_is_finite(tmp_path):
    picture = render(tmp_path / "r.exr", "--replicates", 4)
    assert "hoodoo:replicates (type int): 4" in run("exrheader", picture)
    table = statistics(picture)
    assert table["samples.Y"]["Max"] == 16 and table["variance.R"]["InfCount"] == 0


def test_a_png_is_marked_and_exposed(tmp_path):
    dark, bright = tmp_path / "a.png", tmp_path / "b.png"
    render(dark)
    assert 'oiio:ColorSpace: "sRGB"' in run("oiiotool", "--info", "-v", dark)
    render(bright, "--set", "film.exposure=-6")
    average = [float(re.search(r"Stats Avg: ([.\d]+)", run("oiiotool", "--stats", name)).group(1)) for name in (dark, bright)]
    assert 10 < average[0] < average[1]


def test_the_view_is_the_scenes(tmp_path):
    names = [tmp_path / f"{i}.png" for i in range(2)]
    render(names[0])
    render(names[1], "--set", "film.view=Un-tone-mapped")
    assert pixel_hash(names[0]) != pixel_hash(names[1])


@pytest.mark.parametrize(
    "more, code, text",
    [
        (["--set", "film.view=Un-tone-maped"], 2, 'did you mean "Un-tone-mapped"'),
        (["--set", "film.display=television"], 2, "no such display"),
        (["--colorconfig", "/absent/no.ocio"], 3, "no.ocio"),
        (["--pixel-bounds", "0,49,0,27"], 2, "must be a part of the picture"),
    ],
)
def test_what_cannot_be_shown_is_refused_and_nothing_is_written(tmp_path, more, code, text):
    output = tmp_path / "w.png"
    done = subprocess.run([HOODOO, "render", SCENE, "--quiet", "-r", "48", "27", "-o", output, *more], capture_output=True, text=True, timeout=300)
    assert done.returncode == code and text in done.stderr
    assert list(tmp_path.iterdir()) == []
