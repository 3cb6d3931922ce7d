"""Sampled solids in Python: arrays and files in, tools, values with gradients and intervals, files out."""
import math
import threading

import numpy as np
import pytest

import hoodoo


def ball(n=33, radius=1.2, cell=0.1):
    """Signed distances to a ball about the origin, and where sample (0, 0, 0) stands."""
    first = -0.5 * cell * (n - 1)
    x = first + cell * np.arange(n)
    return np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2) - radius, (first,) * 3


def ball_grid(**more):
    values, origin = ball(**more)
    return hoodoo.VoxelGrid(values, cell=more.get("cell", 0.1), origin=origin, meaning="distance")


def test_a_grid_of_an_array_knows_its_shape_and_place():
    grid = hoodoo.VoxelGrid(np.zeros((4, 5, 6)), cell=0.5, origin=(1, 2, 3))
    assert grid.shape == (4, 5, 6) and grid.cell == 0.5 and grid.origin == (1.0, 2.0, 3.0)
    assert grid.memory_bytes > 0


def test_values_are_the_trilinear_ones_of_the_samples():
    # The eight corners of one cell, by hand: F = iso - density, x the first index.
    density = np.arange(8, dtype=float).reshape(2, 2, 2)
    grid = hoodoo.VoxelGrid(density, cell=2.0, origin=(10, 20, 30), iso=3.25)
    corner = lambda i, j, k: grid.value([10 + 2 * i, 20 + 2 * j, 30 + 2 * k])
    for i, j, k in np.ndindex(2, 2, 2):
        assert corner(i, j, k) == 3.25 - density[i, j, k]
    # A linear function is met exactly: density = 4 u + 2 v + w.
    u, v, w = 0.3, 0.6, 0.9
    p = [10 + 2 * u, 20 + 2 * v, 30 + 2 * w]
    assert grid.value(p) == pytest.approx(3.25 - (4 * u + 2 * v + w), abs=1e-12)
    np.testing.assert_allclose(grid.gradient(p), [-2.0, -1.0, -0.5], atol=1e-12)
    np.testing.assert_array_equal(grid.array(), (3.25 - density).astype(np.float32))


def test_a_solid_has_values_gradients_and_proved_intervals():
    grid = ball_grid()
    random = np.random.default_rng(1)
    d = random.normal(size=(500, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    # The interpolation is off by at most 3 cell^2 / (8 radius) at the surface.
    assert np.abs(grid.value(1.2 * d)).max() < 3 * 0.01 / (8 * 1.2)
    g = grid.gradient(1.2 * d)
    # ... and its gradient by half a cell's turn of the normal, 0.05 / 1.2, along each axis.
    assert np.abs(g - d).max() < 0.05 / 1.2 * 1.5
    assert np.isnan(grid.value([math.nan, 0, 0])) and np.isnan(grid.gradient([math.inf, 0, 0])).all()
    for _ in range(50):
        low = random.uniform(-1.5, 1.3, 3)
        high = low + random.uniform(0, 0.4, 3)
        inside = grid.value(random.uniform(low, high, (300, 3)))
        least, most = grid.interval(low, high)
        assert least <= inside.min() + 1e-9 and inside.max() <= most + 1e-9
        a, b = grid.value(low), grid.value(high)
        assert abs(a - b) <= grid.slope_bound(low, high) * np.linalg.norm(high - low) + 1e-9
    with pytest.raises(hoodoo.Error, match="low <= high"):
        grid.interval([1, 0, 0], [0, 1, 1])


def test_tools_change_the_grid_and_leave_older_fields_alone():
    grid = ball_grid()
    before = grid.field
    assert before.value([0, 0, 0]) < 0
    grid.sculpt(points=[[0, 0, 0], [0, 0, 2]], radius=[0.5])
    assert grid.value([0, 0, 0.9]) > 0 > before.value([0, 0, 0.9])
    assert grid.value([0.9, 0, 0]) < 0
    grid.edit("sculpt", points=[[0, 0, 0.9]], radius=[0.4], mode="add")
    assert grid.value([0, 0, 0.9]) < 0
    volume = lambda g: int((g.array() < 0).sum())
    whole = volume(grid)
    twin = grid.copy()
    grid.smooth(radius=0.2)
    assert abs(volume(grid) - whole) < 0.05 * whole
    grid.weather(depth=0.2, bubble=0.3)
    # A ball of 1.2 m that loses at least 0.2 m all around.
    assert 0.2 * whole < volume(grid) < (1.0 / 1.2) ** 3 * whole * 1.02
    assert volume(twin) == whole


def test_weathering_rounds_a_block():
    n, cell = 32, 0.1
    block = np.zeros((n, n, n))
    block[4:28, 4:28, 4:28] = 1.0
    grid = hoodoo.VoxelGrid(block, cell=cell)
    grid.weather(depth=0.4, bubble=0.4)
    first = lambda line: next(k for k, v in enumerate(line) if v < 0)
    values = grid.array()
    face, corner = first(values[16, 16, :]), first([values[k, k, k] for k in range(n)])
    assert face == 8   # 4 cells of depth
    assert corner >= 10


def test_the_same_seed_gives_the_same_bits():
    def weathered(**more):
        grid = ball_grid()
        grid.weather(depth=0.2, bubble=0.3, noise=0.7, noise_wavelength=0.5, **more)
        return grid.array()
    np.testing.assert_array_equal(weathered(), weathered())
    assert (weathered() != weathered(seed=1)).any()
    assert (weathered() != weathered(name="rain")).any()


@pytest.mark.parametrize("call, text", [
    (lambda g: g.edit("sculp"), 'did you mean "sculpt"'),
    (lambda g: g.smooth(radius=0.01), "the radius of a smoothing, expected 1 to 16 cells"),
    (lambda g: g.weather(depth=0.1), "bubble"),
    (lambda g: g.weather(depth=0.1, bubble=0.3, dept=1.0), 'unknown key "dept" in weather'),
    (lambda g: g.sculpt(points=[[0, 0, 0]], radius=[-1.0]), "radius is out of range"),
])
def test_tools_that_cannot_be_are_errors_and_leave_the_grid_alone(call, text):
    grid = ball_grid()
    before = grid.array()
    with pytest.raises(hoodoo.Error, match=text):
        call(grid)
    np.testing.assert_array_equal(grid.array(), before)


@pytest.mark.parametrize("make, text", [
    (lambda: hoodoo.VoxelGrid(np.zeros((3, 4))), "an array of three axes"),
    (lambda: hoodoo.VoxelGrid(np.zeros((3, 0, 4))), "1 to 65536 samples, got 0"),
    (lambda: hoodoo.VoxelGrid(np.full((2, 2, 2), math.nan)), r"8 of the voxels are not finite, the first is \\(0, 0, 0\\)"),
    (lambda: hoodoo.VoxelGrid(np.zeros((2, 2, 2)), cell=0.0), "the cell of a voxel grid"),
    (lambda: hoodoo.VoxelGrid(np.zeros((2, 2, 2)), iso=-1.0), "an iso above 0"),
    (lambda: hoodoo.VoxelGrid(np.zeros((2, 2, 2)), meaning="colour"), '"density", "distance" or "auto"'),
    (lambda: hoodoo.VoxelGrid.read("/nowhere/at_all.npy"), "cannot read the voxels"),
])
def test_what_is_no_solid_is_an_error(make, text):
    with pytest.raises(hoodoo.Error, match=text.replace("\\\\", "\\")):
        make()


@pytest.mark.parametrize("ending", ["npy", "vdb"])
def test_a_solid_that_is_written_and_read_is_the_same(tmp_path, ending):
    grid = ball_grid()
    grid.sculpt(points=[[0.3, 0.2, 1.0]], radius=[0.45])
    path = tmp_path / f"ball.{ending}"
    grid.write(path)
    more = {"cell": grid.cell, "origin": grid.origin} if ending == "npy" else {}
    again = hoodoo.VoxelGrid.read(path, meaning="distance", **more)
    p = np.random.default_rng(3).uniform(-1.5, 1.5, (4000, 3))
    near = np.abs(grid.value(p)) < 0.04
    assert near.sum() > 100
    np.testing.assert_allclose(again.value(p[near]), grid.value(p[near]), atol=1e-6)
    np.testing.assert_array_equal(again.value(p) < 0, grid.value(p) < 0)


def test_a_scene_traces_what_python_wrote(tmp_path):
    grid = ball_grid()
    grid.write(tmp_path / "ball.npy")
    (tmp_path / "ball.toml").write_text(f"""
version = 1
[camera]
eye = [0, -5, 0]
target = [0, 0, 0]
hfov_deg = 40
[terrain.ball]
type = "voxels"
file = "ball.npy"
values = "distance"
cell = {grid.cell}
origin = [{", ".join(map(str, grid.origin))}]
""")
    scene = hoodoo.load(tmp_path / "ball.toml")
    t = scene.intersect([[0, -5, 0]], [[0, 1, 0]])["t"][0]
    assert t == pytest.approx(3.8, abs=1e-3)
    assert scene.field("ball").value([0, -5 + t, 0]) == pytest.approx(0.0, abs=1e-7)
    assert grid.value([0, -5 + t, 0]) == pytest.approx(0.0, abs=1e-6)


def test_other_threads_may_ask_while_a_tool_works():
    grid = ball_grid()
    failures = []

    def ask():
        for _ in range(200):
            if not grid.value([0, 0, 0]) < 0:
                failures.append("the middle of the ball is no matter")
    threads = [threading.Thread(target=ask) for _ in range(2)]
    for t in threads:
        t.start()
    for _ in range(4):
        grid.smooth(radius=0.1)
    for t in threads:
        t.join()
    assert failures == []


def test_every_tool_is_a_method_with_a_docstring_of_its_parameters():
    for tool in hoodoo.voxel_tools():
        text = getattr(hoodoo.VoxelGrid, tool["name"]).__doc__
        for name in tool["parameters"]:
            assert name in text
    assert "[m]" in hoodoo.VoxelGrid.weather.__doc__
    for name in ("value", "gradient", "interval", "slope_bound", "array", "read"):
        assert "->" in getattr(hoodoo.VoxelGrid, name).__doc__


# -- Every field ------------------------------------------------------------------------------------------------------

ROWS = {
    "plane": 'normal = [0.2, 0.1, 1.0]\nextent = 10.0',
    "convolution": 'columns = [8, 8]\ncell = 1.0\n[[terrain.x.layer]]\nshape = "flat"\ntop = 3.0',
    "warped": 'base = "base"\npatch = 1.0\nregion_min = [-4, -4, -4]\nregion_max = [4, 4, 4]\n[[terrain.x.flow]]\nkind = "vortex"\nradius = 2.0',
    "canyon": 'cell = 8.0\nheight = 6.0\nextent = 12.0\npatch = 1.0',
    "breaking_wave": 'extent = 12.0\npatch = 1.0\n[[terrain.x.wave]]\ncentre = [20, 0]\nsteepening = 5.0\npeel = 3.0\npeel_width = 2.0\nintensity = 4.8',
    "voxels": 'base = "base"\ncell = 0.5\nregion_min = [-3, -3, -3]\nregion_max = [3, 3, 3]',
    "implicit": '[[terrain.x.node]]\nname = "ball"\nkind = "point"\nat = [0, 0, 0]\nradius = 1.5',
    "cracked": 'base = "base"\nn = 20\nzero = -2.0\none = 2.0',
    "elevation": 'relief = 2.0\nwavelength = 5.0\noctaves = 3\nextent = 20.0\npatch = 1.0',
}


@pytest.mark.parametrize("row", ROWS)
def test_every_field_of_a_scene_has_value_gradient_and_interval(row):
    field = hoodoo.load(f"""
version = 1
[camera]
eye = [0, -20, 5]
target = [0, 0, 0]
hfov_deg = 40
[terrain.base]
type = "plane"
normal = [0.2, -0.1, 1.0]
extent = 10.0
visible = true
[terrain.x]
type = "{row}"
{ROWS[row]}
""").field("x")
    random = np.random.default_rng(2)
    for _ in range(30):
        low = random.uniform(-3, 2, 3)
        high = low + random.uniform(0, 1, 3)
        points = random.uniform(low, high, (200, 3))
        inside = field.value(points)
        assert np.isfinite(inside).all() and field.gradient(points).shape == (200, 3)
        least, most = field.interval(low, high)
        assert least <= inside.min() + 1e-9 and inside.max() <= most + 1e-9
        a, b = field.value([low, high])
        assert abs(a - b) <= field.slope_bound(low, high) * np.linalg.norm(high - low) + 1e-9
        # Where the function is smooth its gradient is what differences say.
        p, h = points[0], 1e-5
        steps = np.array([field.value(p + h * e) - field.value(p - h * e) for e in np.eye(3)]) / (2 * h)
        if not np.allclose(steps, field.gradient(p), atol=1e-3):
            # A crease, or a cell's side, lies within h of the point: one-sided slopes differ there, and the gradient is one of them or between.
            one_sided = [abs(field.value(p + h * e) - 2 * field.value(p) + field.value(p - h * e)) / h for e in np.eye(3)]
            assert max(one_sided) > 1e-4, row
