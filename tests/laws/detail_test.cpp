// Level of detail while the eye draws near: nothing pops, nothing flickers, in pictures without noise. A dolly with one ray a pixel is the hardest
// case: what is finer than a pixel and still there is met at another place in every frame.
#include "renderer/geometry/tracer.h"
#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "tests/counts.h"
#include "tests/support/surface_laws.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

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

    double spread() const { return 0.8 / width; }
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
        const auto top = [&](const std::vector<double>& of, int x) {
            int y = 0;
            while (y < dolly.height && of[static_cast<std::size_t>(y * dolly.width + x)] < 0.0) ++y;
            return y;
        };
        for (int x = 0; frame > 0 && x < dolly.width; ++x) {
            if (std::abs(top(picture, x) - top(before, x)) > 1)
                return {fmt::format("frame {}: the silhouette of column {} jumps from {} to {}", frame, x, top(before, x), top(picture, x))};
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
const Dolly kNear{Vec3d(-58.0, 0.3, 14.0), Vec3d(0.05, 0.0, 0.0)};

Seen canyon(const std::string& more)
{
    return [=](const Viewpoint& view) {
        return built("canyon", "cell = 10.0\nheight = 10.0\noctaves = 7\nextent = 60.0\ncentre = [0, 0, 5]\npatch = 3.0\n" + more, view);
    };
}

/// Hills far away whose relief, much finer than a pixel, is a flow's.
Seen curled_hills(const std::string& more)
{
    return [=](const Viewpoint& view) {
        const std::shared_ptr<const Surface> hills = std::move(std::get<std::unique_ptr<Surface>>(
            *built("elevation", "extent = 60.0\ncentre = [0, 0]\nrelief = 5.0\nwavelength = 40.0\noctaves = 1\npatch = 4.0\n", view)));
        return built("warped",
                     "base = \"hills\"\npatch = 3.0\nregion_min = [-50, -50, -12]\nregion_max = [50, 50, 12]\n" + more +
                         "[[flow]]\nkind = \"vertical\"\nwavelength = 3.0\noctaves = 5\ngain = 0.5\nstrength = 0.5\n"
                         "[[flow]]\nkind = \"curl\"\nwavelength = 20.0\noctaves = 1\nstrength = 0.3\n",
                     view, hills);
    };
}

/// Layers with beds and roughness finer than a pixel, turned by a vortex.
Seen turned_layers(const std::string& more)
{
    const std::shared_ptr<const Surface> hill = std::move(std::get<std::unique_ptr<Surface>>(*built(
        "convolution",
        "columns = [200, 200]\ncell = 0.25\norigin = [-25, -25, -5]\nsigma_cells = 1.0\n[[layer]]\nshape = \"fractal\"\nheight = 6.0\nrelief = 5.0\n"
        "wavelength = 6.0\noctaves = 5\ngain = 0.7\n",
        std::nullopt)));
    return [=](const Viewpoint& view) {
        return built("warped",
                     "base = \"hill\"\npatch = 2.0\n" + more +
                         "[[flow]]\nkind = \"vortex\"\ncentre = [0, 0, 0]\naxis = [0, 1, 0.1]\nradius = 12.0\n"
                         "strength = 0.3\n",
                     view, hill);
    };
}

TEST(Detail, a_canyon_neither_pops_nor_flickers_while_the_eye_draws_near)
{
    EXPECT_EQ(neither_pops_nor_flickers(canyon(""), kNear, count(5, 48)).fault, "");
    EXPECT_NE(neither_pops_nor_flickers(canyon("lod = false\n"), kNear, 12).fault, "");
}

TEST(Detail, hills_with_a_flow_s_relief_neither_pop_nor_flicker)
{
    EXPECT_EQ(neither_pops_nor_flickers(curled_hills(""), kNear, count(5, 48)).fault, "");
    EXPECT_NE(neither_pops_nor_flickers(curled_hills("lod = false\n"), kNear, 12).fault, "");
}

TEST(Detail, warped_layers_neither_pop_nor_flicker)
{
    const Dolly far{Vec3d(-220.0, 0.3, 30.0), Vec3d(0.2, 0.0, 0.0), 64, 40, 0.1};
    EXPECT_EQ(neither_pops_nor_flickers(turned_layers(""), far, count(5, 48)).fault, "");
    EXPECT_NE(neither_pops_nor_flickers(turned_layers("lod = false\n"), far, 12).fault, "");
}

}  // namespace
}  // namespace hoodoo
