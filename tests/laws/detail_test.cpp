// Level of detail while the eye draws near: nothing pops, nothing flickers, in pictures without noise. A dolly with one ray a pixel is the hardest
// case: what is finer than a pixel and still there is met at another place in every frame.
#include "renderer/geometry/tracer.h"
#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "tests/counts.h"
#include "tests/support/surface_laws.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

std::unique_ptr<Shape> built(const std::string& type, const std::string& text, const std::optional<Viewpoint>& view,
                             const std::shared_ptr<const Surface>& base = nullptr)
{
    const CatalogueEntry* row = find_in_catalogue(type);
    SceneBudget budget;
    std::vector<Problem> problems;
    const Values values = check(row->schema, parse_toml(text, "<test>", budget, problems), problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    BuildContext context;
    context.seed = 3;
    context.view = view;
    context.base = [&](const std::string&, const Source&) { return base; };
    return std::make_unique<Shape>(row->make(values, context));
}

/// The terrain as it is seen from an eye.
using Seen = std::function<std::unique_ptr<Shape>(const Viewpoint&)>;

struct Dolly {
    Vec3d eye, step;
    int width = 96, height = 48;
    double horizon = 0.35;  ///< share of the height above it
    int rays = 1;           ///< along the side of a pixel: width and height count rays

    double spread() const { return 0.8 * rays / width; }
};

/// A picture without noise, looking along x: how bright the ground is in each pixel, below 0 where there is none.
std::vector<double> still_picture(const Seen& terrain, const Dolly& dolly, const Vec3d& eye)
{
    std::vector<Shape> shapes;
    shapes.push_back(std::move(*terrain({eye, dolly.spread()})));
    const auto tracer = make_embree_tracer(shapes);
    const Vec3d sun = Vec3d(-0.6, 0.3, 0.7).normalized();
    std::vector<double> picture;
    for (int y = 0; y < dolly.height; ++y) {
        for (int x = 0; x < dolly.width; ++x) {
            Ray ray;
            ray.origin = eye;
            ray.direction =
                Vec3d(1.0, ((x + 0.5) / dolly.width - 0.5) * 0.8, ((dolly.height * dolly.horizon - y - 0.5) / dolly.width) * 0.8).normalized();
            const TraceHit hit = tracer->intersect(ray);
            picture.push_back(hit.valid ? std::max(0.0, tracer->interact(ray, hit).shading_normal.dot(sun)) + 0.2 : -1.0);
        }
    }
    return picture;
}

/// No silhouette jumps by more than a pixel from frame to frame, and the second difference of the mean luminance stays under 0.5%.
Verdict neither_pops_nor_flickers(const Seen& terrain, const Dolly& dolly, int frames)
{
    std::vector<double> before, means;
    for (int frame = 0; frame < frames; ++frame) {
        const std::vector<double> picture = still_picture(terrain, dolly, dolly.eye + dolly.step * frame);
        double sum = 0.0;
        for (const double p : picture) sum += std::max(p, 0.0);
        means.push_back(sum / static_cast<double>(picture.size()));
        if (means.front() < 0.1) return {"there is hardly anything to see"};
        // A pixel that turns from sky to ground, or back, had one of its new kind beside it.
        for (int i = 0; frame > 0 && i < dolly.width * dolly.height; ++i) {
            const auto ground = [&](const std::vector<double>& of, int at) { return of[static_cast<std::size_t>(at)] >= 0.0; };
            if (ground(picture, i) == ground(before, i)) continue;
            const int x = i % dolly.width, y = i / dolly.width;
            bool beside = false;
            for (int b = std::max(y - 1, 0); b <= std::min(y + 1, dolly.height - 1); ++b)
                for (int a = std::max(x - 1, 0); a <= std::min(x + 1, dolly.width - 1); ++a)
                    beside = beside || ground(before, b * dolly.width + a) == ground(picture, i);
            if (!beside) return {fmt::format("frame {}: the silhouette at ({}, {}) jumps by more than a pixel", frame, x, y)};
        }
        before = picture;
        const std::size_t k = means.size() - 1;
        if (k < 2) continue;
        const double second = std::abs(means[k] - 2.0 * means[k - 1] + means[k - 2]) / means[k];
        if (!(second < 0.005)) return {fmt::format("frame {}: the luminance's second difference is {:.4f}", frame, second)};
    }
    return {};
}

/// A thousandth of the distance to what is seen each frame: nothing moves by a pixel of itself.
const Dolly kNear{Vec3d(-45.0, 0.3, 14.0), Vec3d(0.04, 0.0, 0.0)};
const Dolly kRim{Vec3d(-29.0, 0.3, 14.0), Vec3d(0.03, 0.0, 0.0)};
const Dolly kFar{Vec3d(-90.0, 0.3, 25.0), Vec3d(0.09, 0.0, 0.0), 96, 60, 0.1, 2};

Seen canyon()
{
    return [=](const Viewpoint& view) {
        return built("canyon", "cell = 10.0\nheight = 10.0\noctaves = 6\nextent = 22.0\ncentre = [0, 0, 5]\npatch = 4.0\n", view);
    };
}

/// Hills whose relief, down to a fraction of a pixel, is a flow's.
Seen hills()
{
    return [=](const Viewpoint& view) {
        const std::shared_ptr<const Surface> base = std::move(std::get<std::unique_ptr<Surface>>(
            *built("elevation", "extent = 45.0\ncentre = [0, 0]\nrelief = 4.0\nwavelength = 40.0\noctaves = 1\npatch = 5.0\n", view)));
        return built("warped",
                     "base = \"hills\"\npatch = 4.0\nregion_min = [-40, -40, -9]\nregion_max = [40, 40, 9]\n[[flow]]\nkind = "
                     "\"vertical\"\nwavelength = 3.0\noctaves = 4\ngain = 0.5\nstrength = 0.5\n",
                     view, base);
    };
}

/// Layers rougher than a pixel is wide, turned by a vortex.
Seen turned_layers()
{
    const std::shared_ptr<const Surface> base = std::move(std::get<std::unique_ptr<Surface>>(
        *built("convolution",
               "columns = [56, 56]\ncell = 1.0\norigin = [-28, -28, -5]\nsigma_cells = 0.5\n[[layer]]\nshape = \"fractal\"\nheight = 6.0\n"
               "relief = 6.0\nwavelength = 5.0\noctaves = 4\n",
               std::nullopt)));
    return [=](const Viewpoint& view) {
        return built(
            "warped",
            "base = \"layers\"\npatch = 3.0\n[[flow]]\nkind = \"vortex\"\ncentre = [0, 0, 0]\naxis = [0, 1, 0.1]\nradius = 12.0\nstrength = 0.2\n",
            view, base);
    };
}

/// A mutant: from the third frame on detail is that of pixels eight times as wide. No law may let that pass.
Seen popping(const Seen& terrain, const Dolly& dolly)
{
    return [=](Viewpoint view) {
        if (view.eye.x > dolly.eye.x + 1.5 * dolly.step.x) view.spread *= 8.0;
        return terrain(view);
    };
}

TEST(Detail, a_canyon_neither_pops_nor_flickers_while_the_eye_draws_near)
{
    EXPECT_EQ(neither_pops_nor_flickers(canyon(), kRim, count(4, 48)).fault, "");
    EXPECT_NE(neither_pops_nor_flickers(popping(canyon(), kRim), kRim, 3).fault, "");
}

TEST(Detail, hills_with_a_flow_s_relief_neither_pop_nor_flicker)
{
    EXPECT_EQ(neither_pops_nor_flickers(hills(), kNear, count(6, 48)).fault, "");
    EXPECT_NE(neither_pops_nor_flickers(popping(hills(), kNear), kNear, 3).fault, "");
}

TEST(Detail, warped_layers_neither_pop_nor_flicker)
{
    EXPECT_EQ(neither_pops_nor_flickers(turned_layers(), kFar, count(6, 48)).fault, "");
    EXPECT_NE(neither_pops_nor_flickers(popping(turned_layers(), kFar), kFar, 3).fault, "");
}

}  // namespace
}  // namespace hoodoo
