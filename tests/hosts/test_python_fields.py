"""The Python module on fields and stacks: golden values, edit tools, the catalogue, analyses, bounds."""
import json
import math
import pathlib

import numpy as np
import pytest

import hoodoo

ROOT = pathlib.Path(__file__).resolve().parents[2]
MATERIALS = ["air", "water", "sand", "bedrock", "rock"]   # the numbering of the golden file


@pytest.fixture(scope="module")
def golden():
    return json.loads((ROOT / "tests/golden/a_arches.json").read_text())


@pytest.fixture()
def stack(golden):
    columns = [[[(MATERIALS[m], top) for m, top in column] for column in row] for row in golden["stacks"]]
    return hoodoo.MaterialStack(golden["s"], columns, unit=0.01)


# -- fields and stacks -----------------------------------------------------------------------------------------------


def test_field_values_and_gradients_are_the_golden_ones_negated(golden, stack):
    for case in golden["field"]:
        for key, materials in (("f_ground", ("sand", "bedrock")), ("f_bedrock", ("bedrock",))):
            field = hoodoo.ConvolutionField(stack, case["sigma"], materials)
            assert field.value([case["p"]])[0] == pytest.approx(-case[key], abs=1e-12)
        gradient = hoodoo.ConvolutionField(stack, case["sigma"]).gradient([case["p"]])[0]
        np.testing.assert_allclose(gradient, -np.array(case["grad_ground"]), atol=1e-12)


def test_field_is_negative_inside_and_keeps_the_shape_of_its_points(stack):
    field = hoodoo.ConvolutionField(stack, 1.0)
    points = np.zeros((4, 5, 3))
    points[..., 2] = -10.0
    assert field.value(points).shape == (4, 5)
    assert field.gradient(points).shape == (4, 5, 3)
    assert (field.value(points) == -1.0).all()
    assert field.value([3.0, 2.0, 100.0]) == 1.0
    assert math.isnan(field.value([math.nan, 0.0, 0.0]))


def test_columns_come_back_rounded_to_units_and_merged():
    stack = hoodoo.MaterialStack(2.0, [[[("bedrock", 10.004), ("sand", 12.0), ("sand", 13.0)], [("bedrock", 5.0)]]], origin=(1, 2, 3), unit=0.01)
    assert stack.columns == [[[("bedrock", pytest.approx(10.0)), ("sand", pytest.approx(13.0))], [("bedrock", pytest.approx(5.0))]]]
    assert stack.shape == (1, 2)
    assert stack.origin == (1, 2, 3)
    assert stack.layer_count == 3
    assert stack.memory_bytes > 0


def test_default_unit_is_the_highest_top_over_8000():
    assert hoodoo.MaterialStack(1.0, [[[("bedrock", 400.0)]]]).unit == pytest.approx(0.05)


@pytest.mark.parametrize("columns, text", [
    ([[[("bedrok", 1.0)]]], "bedrock"),
    ([[[("sand", 2.0), ("bedrock", 1.0)]]], "column"),
    ([[[("sand", math.nan)]]], "out of range"),
    ([[[("sand", 1.0)]], []], "another length"),
    ([], "empty"),
])
def test_wrong_columns_are_errors(columns, text):
    with pytest.raises(hoodoo.Error, match=text):
        hoodoo.MaterialStack(1.0, columns)


def flat(n=24, top=10.0):
    return hoodoo.MaterialStack(1.0, [[[("bedrock", top)] for _ in range(n)] for _ in range(n)], unit=0.01)


def test_tools_edit_a_stack_one_after_another_and_say_what_they_changed():
    stack = flat()
    before = stack.copy()
    field = hoodoo.ConvolutionField(stack, 1.0)
    assert field.value([12.5, 12.5, 10.2]) > 0
    raised = stack.edit("sculpt", target=[12.5, 12.5, 10.0], radius=4.0, strokes=2)
    assert raised.dtype == np.int32 and raised.shape[1] == 2 and len(raised) > 20
    assert field.value([12.5, 12.5, 10.2]) < 0  # the field follows its stack
    carved = stack.edit("sweep", points=np.array([[4.0, 4.0, 9.0], [20.0, 6.0, 9.0]]), radius=[1.5])
    touched = {tuple(c) for c in np.concatenate([raised, carved])}
    differing = {(i, j) for i in range(24) for j in range(24) if stack.columns[i][j] != before.columns[i][j]}
    assert differing and differing <= touched
    assert touched == differing  # bedrock alone: nothing slides on


def test_every_tool_is_listed_and_takes_what_it_lists():
    tools = {tool["name"]: tool for tool in hoodoo.tools()}
    assert {"sculpt", "sweep", "deposit", "erode", "fill", "stabilise"} <= set(tools)
    assert "[m]" in tools["sculpt"]["parameters"]["radius"]
    assert "stabilise" in tools["sweep"]["parameters"]


@pytest.mark.parametrize("tool, parameters, text", [
    ("sculp", {}, 'did you mean "sculpt"'),
    ("sculpt", {"target": [1.0, 1.0, 1.0], "radius": -1.0}, "radius is out of range"),
    ("sculpt", {"target": [1.0, 1.0, 1.0], "radios": 1.0}, 'unknown key "radios" in sculpt'),
    ("sculpt", {"target": [100.0, 1.0, 1.0], "radius": 1.0}, "the tool lies outside the terrain"),
    ("sweep", {"points": [[1, 1, 1], [9, 9, 1], [9, 1, 1], [1, 9, 1]], "radius": [0.5]}, "the skeleton crosses itself"),
])
def test_edits_that_cannot_be_are_errors_and_leave_the_stack_alone(tool, parameters, text):
    stack = flat()
    with pytest.raises(hoodoo.Error, match=text):
        stack.edit(tool, **parameters)
    assert stack.columns == flat().columns


def test_noise_of_an_edit_depends_on_seed_and_name():
    def edited(**more):
        stack = flat()
        stack.edit("sculpt", target=[12.0, 12.0, 10.0], radius=4.0, strokes=5, scatter=5.0, **more)
        return stack.columns
    assert edited() == edited()
    assert edited() != edited(seed=1)
    assert edited() != edited(name="knobs")


def test_errors_are_value_errors_and_wrong_shapes_are_errors(stack):
    assert issubclass(hoodoo.Error, ValueError)
    with pytest.raises(hoodoo.Error, match="sigma"):
        hoodoo.ConvolutionField(stack, 0.0)
    with pytest.raises(hoodoo.Error, match="wrong shape"):
        hoodoo.ConvolutionField(stack, 1.0).value([[1.0, 2.0]])


def test_every_row_of_the_catalogue_is_listed_and_a_wrong_one_is_named(tmp_path):
    names = [row["name"] for row in hoodoo.catalogue()]
    assert "mesh" in names and "convolution" in names
    with pytest.raises(hoodoo.Error, match="convolution"):
        hoodoo.field("convolutio")
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(hoodoo.Error, match="no field"):
        hoodoo.field("mesh", file=str(tmp_path / "one.obj"))
    assert hoodoo.field("plane").value([[0.0, 0.0, 2.0]]) == pytest.approx([2.0])


FLAT = dict(columns=[8, 8], cell=1.0, sigma=1.0, layer=[dict(shape="flat", top=10.0, material="bedrock")])


def test_a_field_of_the_catalogue_answers_like_any_other():
    # Flat ground up to z = 10: of the cube 8.5 to 10.5 three quarters are matter, f = 1 - 6 / 4.
    field = hoodoo.field("convolution", **FLAT)
    np.testing.assert_allclose(field.value([[4, 4, 10.0], [4, 4, 9.5], [4, 4, 20.0]]), [0.0, -0.5, 1.0], atol=1e-9)
    np.testing.assert_allclose(field.gradient([4, 4, 10.0]), [0, 0, 1], atol=1e-9)
    with pytest.raises(hoodoo.Error, match="sigm"):
        hoodoo.field("convolution", sigm=1.0, **FLAT)


# -- Analysis ---------------------------------------------------------------------------------------------------------

def test_analysis_gives_the_golden_drainage_and_wetness():
    golden = json.loads((ROOT / "tests/golden/b_galin.json").read_text())["drainage"]
    z, cell = np.array(golden["Z"]), golden["cell"]
    area, slope, downstream = hoodoo.analysis.drainage(z, cell)
    np.testing.assert_array_equal(area, golden["A_m2"])
    np.testing.assert_allclose(slope, golden["s"], atol=1e-12)
    assert downstream[4, 4] == -1 and downstream.dtype == np.int64
    np.testing.assert_allclose(hoodoo.analysis.wetness(z, cell), golden["wetness_tan"], atol=1e-12)
    np.testing.assert_allclose(hoodoo.analysis.wetness(z, cell, kind="cover"), golden["wetness_cover_formula"], atol=1e-12)


def test_analysis_gives_the_golden_curvatures():
    for case in json.loads((ROOT / "tests/golden/b_galin.json").read_text())["curvature"]:
        z = np.array(case["Z_rows_top_first"]).reshape(3, 3)
        for name, key in [("plan", "plan_slide"), ("profile", "profile_slide"), ("normal", "true_profile"), ("contour", "true_plan_contour"),
                          ("tangential", "true_tangential")]:
            got = getattr(hoodoo.analysis, name + "_curvature")(z, case["C"])[1, 1]
            assert got == pytest.approx(case[key], abs=1e-12), (case["name"], name)


def test_analysis_of_simple_ground():
    y, x = np.mgrid[3:-1:-1, 0:5]
    ramp = 2.0 * y                                       # rises to the north, faces south
    np.testing.assert_allclose(hoodoo.analysis.slope(ramp, 2.0), math.pi / 4)
    np.testing.assert_allclose(hoodoo.analysis.aspect(ramp, 2.0), math.pi)
    np.testing.assert_allclose(hoodoo.analysis.hillshade(ramp, 2.0, azimuth=math.pi, altitude=math.pi / 4), 1.0)
    assert (hoodoo.analysis.fill_pits(ramp, 2.0) == ramp).all()
    with pytest.raises(hoodoo.Error, match="z has a wrong shape"):
        hoodoo.analysis.slope(np.zeros(3), 1.0)
    ramp[1, 2] = math.nan
    with pytest.raises(hoodoo.Error, match="1 that are not, the first at column 2, row 1"):
        hoodoo.analysis.aspect(ramp, 2.0)
    for name in dir(hoodoo.analysis):
        if not name.startswith("_"):
            assert "->" in getattr(hoodoo.analysis, name).__doc__


# -- What is proved of a field ------------------------------------------------------------------------------------------

def test_every_row_with_a_field_has_values_gradients_and_intervals():
    rows = {"plane": {"normal": [0.2, 0.1, 1.0]},
            "cracked": {"n": 20, "zero": -1.0, "one": 1.0, "ground": [{"type": "plane", "extent": 4.0}]},
            "convolution": {"columns": [8, 8], "cell": 1.0, "layer": [{"shape": "flat", "top": 3.0}]}}
    random = np.random.default_rng(2)
    for row, parameters in rows.items():
        field = hoodoo.field(row, **parameters)
        for _ in range(20):
            low = random.uniform(-3, 3, 3)
            high = low + random.uniform(0, 1, 3)
            inside = field.value(random.uniform(low, high, (200, 3)))
            least, most = field.interval(low, high)
            assert least <= inside.min() + 1e-9 and inside.max() <= most + 1e-9, row
            a, b = field.value([low])[0], field.value([high])[0]
            assert abs(a - b) <= field.slope_bound(low, high) * np.linalg.norm(high - low) + 1e-9, row
        assert field.gradient([[0.3, 0.2, 0.1]]).shape == (1, 3)
    with pytest.raises(hoodoo.Error, match="low <= high"):
        field.interval([1, 0, 0], [0, 1, 1])
