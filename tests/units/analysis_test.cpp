// Slopes, curvatures, drainage and wetness against golden values and against what simple shapes must give.
#include "terrain/analysis/drainage.h"
#include "terrain/analysis/slopes.h"
#include "terrain/error.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using Json = nlohmann::json;

const Json& golden()
{
    static const Json data = Json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/b_galin.json"));
    return data;
}

/// A grid that owns its samples.
struct Grid {
    std::vector<double> z;
    int columns, rows;
    double cell = 1.0;
    operator Elevation() const { return {z, columns, rows, cell}; }
};

/// Samples h(x, y) at cell centres, x east, y north, (0, 0) the south-western cell's.
template <class F>
Grid sampled(int columns, int rows, double cell, const F& h)
{
    Grid grid{{}, columns, rows, cell};
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) grid.z.push_back(h(column * cell, (rows - 1 - row) * cell));
    return grid;
}

std::string error_of(const Elevation& elevation)
{
    try {
        slope(elevation);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(Analysis, curvatures_equal_the_golden_values)
{
    int seen = 0;
    for (const Json& c : golden()["curvature"]) {
        const Grid grid{c["Z_rows_top_first"].get<std::vector<double>>(), 3, 3, c["C"]};
        const Quadric q = quadric(grid, 1, 1);
        EXPECT_NEAR(q.d, c["D"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(q.e, c["E"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(q.f, c["F"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(q.g, c["G"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(q.h, c["H"].get<double>(), 1e-12) << c["name"];
        const Curvature k = curvatures(grid)[4];
        EXPECT_NEAR(k.plan, c["plan_slide"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(k.profile, c["profile_slide"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(k.plan, c["second_derivative_along_contour"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(k.profile, -c["second_derivative_along_slope"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(k.normal, c["true_profile"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(k.contour, c["true_plan_contour"].get<double>(), 1e-12) << c["name"];
        EXPECT_NEAR(k.tangential, c["true_tangential"].get<double>(), 1e-12) << c["name"];
        ++seen;
    }
    EXPECT_EQ(seen, 5);
}

TEST(Analysis, drainage_and_wetness_equal_the_golden_values)
{
    const Json& g = golden()["drainage"];
    Grid grid{{}, 5, 5, g["cell"]};
    std::vector<double> area, steep, cover, tangent;
    for (std::size_t row = 0; row < 5; ++row)
        for (std::size_t column = 0; column < 5; ++column) {
            grid.z.push_back(g["Z"][row][column]);
            area.push_back(g["A_m2"][row][column]);
            steep.push_back(g["s"][row][column]);
            cover.push_back(g["wetness_cover_formula"][row][column]);
            tangent.push_back(g["wetness_tan"][row][column]);
        }
    const Drainage d = drainage(grid);
    const std::vector<double> by_cover = wetness(d, grid.cell, WetnessKind::cover), by_tangent = wetness(d, grid.cell, WetnessKind::tangent);
    for (std::size_t k = 0; k < 25; ++k) {
        EXPECT_EQ(d.area[k], area[k]) << k;
        EXPECT_NEAR(d.slope[k], steep[k], 1e-12) << k;
        EXPECT_NEAR(by_cover[k], cover[k], 1e-12) << k;
        EXPECT_NEAR(by_tangent[k], tangent[k], 1e-12) << k;
    }
}

TEST(Analysis, a_tilted_plane_has_one_slope_and_faces_one_way_up_to_its_rim)
{
    // Rises to the east by 1/2 and to the north by 1/4: it faces the south-west by south, 180 + atan(2) degrees.
    const Grid grid = sampled(7, 5, 3.0, [](double x, double y) { return 0.5 * x + 0.25 * y; });
    const std::vector<double> s = slope(grid), a = aspect(grid);
    for (std::size_t k = 0; k < s.size(); ++k) {
        EXPECT_NEAR(s[k], std::atan(std::sqrt(0.3125)), 1e-12) << k;
        EXPECT_NEAR(a[k], 3.141592653589793 + std::atan(2.0), 1e-12) << k;
    }
    for (const Curvature& c : curvatures(grid)) {
        EXPECT_NEAR(c.plan, 0.0, 1e-12);
        EXPECT_NEAR(c.profile, 0.0, 1e-12);
    }
}

TEST(Analysis, aspect_counts_from_north_to_east)
{
    const auto facing = [](double x, double y) { return aspect(sampled(3, 3, 1.0, [&](double u, double v) { return -(x * u + y * v); }))[4]; };
    const double quarter = 1.5707963267948966;
    EXPECT_NEAR(facing(0, 1), 0.0, 1e-12);
    EXPECT_NEAR(facing(1, 0), quarter, 1e-12);
    EXPECT_NEAR(facing(0, -1), 2 * quarter, 1e-12);
    EXPECT_NEAR(facing(-1, 0), 3 * quarter, 1e-12);
    EXPECT_EQ(facing(0, 0), -1.0);
}

TEST(Analysis, hillshade_is_the_cosine_to_the_light)
{
    const Grid flat = sampled(3, 3, 1.0, [](double, double) { return 2.0; });
    EXPECT_NEAR(hillshade(flat, 1.0, 0.5)[4], std::sin(0.5), 1e-12);
    // A slope of 45 degrees that faces east, light from the east at 45 degrees: head on. From the west: in its own shade.
    const Grid east = sampled(3, 3, 1.0, [](double x, double) { return -x; });
    EXPECT_NEAR(hillshade(east, 1.5707963267948966, 0.7853981633974483)[4], 1.0, 1e-12);
    EXPECT_NEAR(hillshade(east, -1.5707963267948966, 0.7853981633974483)[4], 0.0, 1e-12);
    EXPECT_NEAR(hillshade(sampled(3, 3, 1.0, [](double x, double) { return -0.5 * x; }), 1.5707963267948966, 0.7853981633974483, 2.0)[4], 1.0, 1e-12);
}

TEST(Analysis, a_pit_is_filled_to_its_rim_and_drains)
{
    // A bowl of 7 x 7 whose rim is 5, but 3 at one gap.
    Grid bowl = sampled(7, 7, 2.0, [](double, double) { return 1.0; });
    for (int k = 0; k < 7; ++k)
        for (const int other : {0, 6}) bowl.z[static_cast<std::size_t>(7 * k + other)] = bowl.z[static_cast<std::size_t>(7 * other + k)] = 5.0;
    const std::size_t gap = 7 * 3 + 6;
    bowl.z[gap] = 3.0;
    const std::vector<double> filled = fill_pits(bowl);
    for (int row = 1; row < 6; ++row)
        for (int column = 1; column < 6; ++column) {
            const double z = filled[static_cast<std::size_t>(7 * row + column)];
            EXPECT_GT(z, 3.0);
            EXPECT_LT(z, 3.0 + 1e-12);
        }
    const Drainage d = drainage(bowl);
    // 25 cells of the bowl, the gap, and those of the rim that slope into the bowl: all but the four corners' neighbours find it. All leave at the
    // gap.
    double leaving = 0.0;
    for (std::size_t k = 0; k < d.area.size(); ++k)
        if (d.downstream[k] < 0) leaving += d.area[k];
    EXPECT_DOUBLE_EQ(leaving, 49 * 4.0);
    EXPECT_DOUBLE_EQ(d.area[gap], 49 * 4.0);
}

TEST(Analysis, all_water_leaves_a_rough_ground_and_only_downhill)
{
    testing::Numbers random(8);
    const Grid grid = sampled(83, 61, 5.0, [&](double x, double y) { return 20.0 * std::sin(0.02 * x) * std::cos(0.03 * y) + random(); });
    const Drainage d = drainage(grid);
    const std::vector<double> filled = fill_pits(grid);
    double leaving = 0.0;
    int raised = 0;
    for (std::size_t k = 0; k < d.area.size(); ++k) {
        EXPECT_GE(filled[k], grid.z[k]);
        raised += filled[k] > grid.z[k];
        if (d.downstream[k] < 0)
            leaving += d.area[k];
        else
            EXPECT_LT(filled[static_cast<std::size_t>(d.downstream[k])], filled[k]);
        const bool rim = k < 83 || k >= 83 * 60 || k % 83 == 0 || k % 83 == 82;
        EXPECT_TRUE(rim || d.downstream[k] >= 0) << "water is stuck inside";
    }
    EXPECT_DOUBLE_EQ(leaving, 83 * 61 * 25.0);
    EXPECT_GT(raised, 100);
}

TEST(Analysis, grids_that_cannot_be_are_refused)
{
    Grid grid = sampled(3, 2, 1.0, [](double x, double) { return x; });
    Elevation view = grid;
    view.columns = 4;
    EXPECT_EQ(error_of(view), "the size of the elevation grid, expected columns x rows samples, got 4 x 2 and 6 samples");
    view = grid;
    view.cell = 0.0;
    EXPECT_EQ(error_of(view), "the cell of the elevation grid, expected a length above 0, got 0");
    grid.z[4] = grid.z[5] = std::nan("");
    EXPECT_EQ(error_of(grid),
              "samples of the elevation grid are no numbers, expected finite heights, got 2 that are not, the first at column 1, row 1");
    EXPECT_NEAR(slope(sampled(1, 1, 1.0, [](double, double) { return 3.0; }))[0], 0.0, 0.0);
}

}  // namespace
}  // namespace hoodoo
