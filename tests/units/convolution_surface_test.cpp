// The rows plane and convolution, from tables to interactions; and the shading normal's promise.
#include "terrain/catalogue.h"

#include "tests/stacks.h"
#include "tests/tables.h"
#include "terrain/stack/convolution.h"
#include "terrain/surfaces/refine.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using testing::table;

std::unique_ptr<Surface> make(const std::string& row, const Node& parameters)
{
    const CatalogueEntry* entry = find_in_catalogue(row);
    std::vector<Problem> problems;
    const Values values = check(entry->schema, parameters, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    BuildContext context;
    context.name = "ground";
    context.seed = 5;
    return std::get<std::unique_ptr<Surface>>(entry->make(values, context));
}

/// All patches, one after another.
bool nearest(const Surface& surface, const Ray& ray, Hit& hit)
{
    hit = Hit();
    hit.t = ray.t_max;
    bool found = false;
    for (std::uint32_t tile = 0; tile < surface.tile_count(); ++tile) {
        for (std::uint32_t k = 0; k < surface.patch_count(tile); ++k) found |= surface.intersect({tile, k}, ray, hit);
    }
    return found;
}

Node country(const std::string& intersector, const std::string& border = "extend")
{
    return table(
        {{"columns", {24.0, 20.0}},
         {"cell", 2.0},
         {"unit", 0.01},
         {"intersector", intersector},
         {"border", border},
         {"layer", testing::tables({table({{"shape", "fractal"}, {"height", 20.0}, {"relief", 12.0}, {"wavelength", 30.0}, {"beds", 4.0}}),
                                    table({{"shape", "drift"}, {"material", "sand"}, {"thickness", 0.8}}),
                                    table({{"shape", "flat"}, {"material", "rock"}, {"thickness", 0.0}})})},
         {"edit",
          testing::tables({table({{"tool", "sweep"}, {"points", testing::list({{10.0, 0.0, 14.0}, {30.0, 40.0, 15.0}})}, {"radius", {5.0}}})})}});
}

TEST(ConvolutionSurface, interactions_lie_on_the_surface_and_their_spawn_points_in_air)
{
    for (const char* intersector : {"exact", "sphere"}) {
        const auto surface = make("convolution", country(intersector));
        int hits = 0;
        for (std::uint64_t k = 0; k < 300; ++k) {
            Ray ray;
            ray.origin = Vec3d(2 + 44 * unit_real(mix64(5 * k)), 2 + 36 * unit_real(mix64(5 * k + 1)), 60);
            ray.direction = Vec3d(unit_real(mix64(5 * k + 2)) - 0.5, unit_real(mix64(5 * k + 3)) - 0.5, -1).normalized();
            Hit hit;
            if (!nearest(*surface, ray, hit)) continue;
            ++hits;
            const Interaction at = surface->interact(ray, hit);
            EXPECT_NEAR(at.t, hit.t, 2e-3);
            EXPECT_LT(at.position_error, 1e-6);
            EXPECT_FALSE(surface->contains(at.position + at.geometric_normal * at.spawn_offset));
            EXPECT_TRUE(surface->contains(at.position + ray.direction * (2 * at.position_error)));
            EXPECT_LT(at.spawn_offset, 0.02);
            EXPECT_NEAR(at.geometric_normal.length(), 1.0, 1e-12);
            EXPECT_GT(at.geometric_normal.dot(at.shading_normal), 0.0);
            EXPECT_LT(at.geometric_normal.dot(ray.direction), 1e-6);
            double sum = 0.0;
            for (std::size_t m = 0; m < at.materials.count; ++m) sum += at.materials.weight[m];
            EXPECT_NEAR(sum, 1.0, 1e-6);
            // A ray from the spawn point along the normal must not meet what it left.
            Ray next;
            next.origin = at.position + at.geometric_normal * at.spawn_offset;
            next.direction = at.geometric_normal;
            next.t_max = 1e-3;
            Hit again;
            EXPECT_FALSE(nearest(*surface, next, again));
        }
        EXPECT_GT(hits, 190);  // the others leave the grid
    }
}

TEST(ConvolutionSurface, says_what_it_consists_of)
{
    const auto surface = make("convolution", country("auto", "cut"));
    EXPECT_TRUE(surface->closed());
    EXPECT_EQ(surface->materials(), (std::vector<std::string>{"sand", "bedrock", "soil"}));
    const SurfaceInfo info = surface->info();
    EXPECT_EQ(info.columns, 480u);
    EXPECT_GE(info.layers, 480u);
    EXPECT_GT(info.stack_bytes, 960u);
    EXPECT_GT(info.trace_bytes, 0u);
    EXPECT_GT(info.patches, 10u);
    EXPECT_FALSE(surface->contains(Vec3d(24, 20, 200)));
    EXPECT_TRUE(surface->contains(Vec3d(24, 20, 1)));
    EXPECT_FALSE(surface->contains(Vec3d(24, 20, -30)));
    EXPECT_FALSE(surface->contains(Vec3d(-3, 20, 1)));
}

TEST(ConvolutionSurface, traces_rock_layers_as_a_body_of_their_own)
{
    const auto layers = [](const char* rocks) {
        return table({{"columns", {12.0, 12.0}},
                      {"cell", 1.0},
                      {"unit", 0.01},
                      {"rocks", rocks},
                      {"layer", testing::tables({table({{"shape", "flat"}, {"top", 5.0}}),
                                                 table({{"shape", "flat"}, {"material", "rock"}, {"thickness", 4.0}})})}});
    };
    Ray down;
    down.origin = Vec3d(6.2, 6.3, 30);
    down.direction = Vec3d(0, 0, -1);
    Hit hit;
    const auto own = make("convolution", layers("surface")), joined = make("convolution", layers("ground")),
               hidden = make("convolution", layers("hidden"));
    ASSERT_TRUE(nearest(*own, down, hit));
    EXPECT_NEAR(hit.t, 21.0, 1e-4);
    const Interaction at = own->interact(down, hit);
    ASSERT_EQ(at.materials.count, 1u);
    EXPECT_EQ(own->materials()[at.materials.index[0]], "rock");
    ASSERT_TRUE(nearest(*joined, down, hit));
    EXPECT_NEAR(hit.t, 21.0, 1e-4);
    ASSERT_TRUE(nearest(*hidden, down, hit));
    EXPECT_NEAR(hit.t, 25.0, 1e-4);
}

std::string refusal(const Node& parameters)
{
    try {
        make("convolution", parameters);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(ConvolutionSurface, refuses_what_cannot_be_built_at_the_value_that_is_wrong)
{
    const auto with = [](const std::string& key, Node value) {
        Node parameters = country("auto");
        std::get<Node::Table>(parameters.value).push_back({key, std::move(value)});
        return parameters;
    };
    Node odd = with("sigma_cells", testing::number(0.8));
    EXPECT_EQ(refusal(odd), "accepted");  // auto: sphere
    for (auto& [key, value] : std::get<Node::Table>(odd.value)) {
        if (key == "intersector") value = testing::text("exact");
    }
    EXPECT_NE(refusal(odd).find("the exact intersector cannot be used"), std::string::npos);
    EXPECT_NE(refusal(with("datum", testing::number(30.0))).find("set `datum` lower"), std::string::npos);
    EXPECT_NE(refusal(with("sigma", testing::number(500.0))).find("at most 64 cells"), std::string::npos);
    EXPECT_NE(refusal(table({{"layer", testing::tables({table({{"shape", "flat"}, {"top", 1.0}})})}})).find("columns = [nx, ny]"), std::string::npos);
    EXPECT_NE(refusal(table({{"columns", {4.0, 4.0}}, {"layer", testing::tables({table({{"shape", "flat"}, {"top", 1.0}})})}})).find("cell = "),
              std::string::npos);
}

/// Largest angle in degrees between the shading normals 1e-4 s to either side of lattice planes, over `count` points of the surface.
double largest_kink(const ConvolutionField& field, double width, int count)
{
    const MaterialStack& stack = field.ground().stack();
    const double s = stack.cell();
    double largest = 0.0;
    int found = 0;
    for (std::uint64_t k = 0; found < count && k < 40u * static_cast<unsigned>(count); ++k) {
        // A vertical ray within a lattice plane of x; every sign change is a point of the surface.
        const double x = s * std::floor(3 + 24 * unit_real(mix64(3 * k))), y = s * (3 + 24 * unit_real(mix64(3 * k + 1)));
        const double z = stack.unit() * stack.highest_top() * 1.1 * unit_real(mix64(3 * k + 2));
        Ray up;
        up.origin = Vec3d(x, y, z);
        double t = 0.0;
        const double sign = field.value(up.origin);
        while (t < 4 * s && (field.value(up.at(t)) < 0.0) == (sign < 0.0)) t += 0.02 * s;
        if (t >= 4 * s || t == 0.0) continue;
        const Refined at = refine_crossing(field, up, t - 0.01 * s, 0.05, 100 * s);
        if (std::abs(field.value(up.at(at.t))) > 1e-9) continue;
        ++found;
        const Vec3d step(1e-4 * s, 0, 0);
        const Vec3d a = field.smoothed_gradient(up.at(at.t) - step, width).normalized(),
                    b = field.smoothed_gradient(up.at(at.t) + step, width).normalized();
        largest = std::max(largest, std::acos(std::min(1.0, a.dot(b))) * 180 / M_PI);
    }
    EXPECT_EQ(found, count);
    return largest;
}

TEST(ShadingNormals, do_not_jump_at_lattice_planes)
{
    // Rugged columns of beds and gaps, as high as they are wide: far steeper than what a scene shows.
    const auto stack = testing::random_stack(21, {30, 30}, 1.0, 0.01, 400);
    const ConvolutionField field(Ground(stack, kGround, Border::extend), 1.0);
    const double default_width = std::get<double>(find_in_catalogue("convolution")->schema.parameters.back().fallback);
    const int count = 10000;
    EXPECT_LT(largest_kink(field, default_width, count), 0.2);
    EXPECT_GT(largest_kink(field, 1e-5, 500), 5.0);  // mutant: hardly any width is the gradient itself, which jumps
}

TEST(Plane, is_met_where_it_lies)
{
    const auto plane = make("plane", table({{"point", {0.0, 0.0, 3.0}}, {"normal", {0.0, 3.0, 4.0}}, {"extent", 50.0}}));
    Ray ray;
    ray.origin = Vec3d(1, 2, 13);
    ray.direction = Vec3d(0, 0, -1);
    // 3 y + 4 (z - 3) = 0 at y = 2: z = 1.5, so t = 11.5.
    Hit hit;
    ASSERT_TRUE(nearest(*plane, ray, hit));
    EXPECT_NEAR(hit.t, 11.5, 1e-12);
    const Interaction at = plane->interact(ray, hit);
    EXPECT_NEAR((at.geometric_normal - Vec3d(0, 0.6, 0.8)).length(), 0.0, 1e-15);
    EXPECT_FALSE(plane->contains(at.position + at.geometric_normal * at.spawn_offset));
    EXPECT_TRUE(plane->contains(at.position - at.geometric_normal * at.spawn_offset));
    EXPECT_TRUE(plane->patch_bounds({}).intersects(at.position));
    ray.crossing = Crossing::entering;
    ray.origin.z = -13;
    ray.direction = Vec3d(0, 0, 1);
    EXPECT_FALSE(nearest(*plane, ray, hit));
    ray.crossing = Crossing::any;
    EXPECT_TRUE(nearest(*plane, ray, hit));
    ray.origin.x = 51;
    EXPECT_FALSE(nearest(*plane, ray, hit));
}

}  // namespace
}  // namespace hoodoo
