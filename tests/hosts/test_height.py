"""Height files that are larger than the memory there is to spend on them."""
import json
import os
import pathlib
import resource
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HOODOO = os.environ.get("HOODOO", str(ROOT / "build/release/bin/hoodoo"))
NIGHTLY = "HOODOO_NIGHTLY" in os.environ
SANITIZED = os.environ.get("HOODOO_SANITIZED") == "1"


def scene(folder, side):
    image = folder / f"heights_{side}.tif"
    subprocess.run(["oiiotool", "--pattern", "fill:topleft=0:topright=1:bottomleft=1:bottomright=0", f"{side}x{side}", "1", "-d", "uint16",
                    "--tile", "256", "256", "--compression", "lzw", "-o", str(image)], check=True)
    path = folder / f"scene_{side}.toml"
    path.write_text(f"""version = 1
[camera]
eye = [0, 0, 2000]
target = [1000, 1000, 0]
[light.sky]
type = "constant"
radiance = {{ grey = 0.5 }}
[terrain.hills]
type = "heightfield"
file = "{image.name}"
cell = [1.0]
white = 900.0
""")
    return path


def info(path, limit):
    """What `hoodoo info` prints, and the largest memory it held, in bytes."""
    child = subprocess.Popen([HOODOO, "info", str(path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    out, problems = child.stdout.read(), child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    assert status == 0, problems
    return json.loads(out)["terrain"]["hills"], usage.ru_maxrss * 1024


@pytest.mark.skipif(SANITIZED, reason="a sanitizer maps terabytes")
def test_a_tiled_file_is_read_a_row_of_tiles_at_a_time(tmp_path):
    # The program itself maps 0.75 GB of libraries; the rest of the limit is the terrain's. Samples at 2 bytes are 537 MB for 16384^2.
    side, limit, most = (16384, 2_000_000_000, 1200e6) if NIGHTLY else (4096, 900_000_000, 60e6)
    _, small = info(scene(tmp_path, 64), limit)
    terrain, large = info(scene(tmp_path, side), limit)
    assert terrain["trace_bytes"] <= most
    # The whole image beside the grid would add 2 side^2 bytes at the least; Embree's tree takes a sixth of that.
    assert large - small < terrain["trace_bytes"] + 1.2 * side * side
