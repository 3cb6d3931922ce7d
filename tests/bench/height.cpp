// The same mountains sampled at several sizes, seen from the same places: time a ray and memory of `heightfield`, of Embree's triangles and of
// Embree's grid geometry. One thread, one ray at a time; rays of the baselines go to Embree without a wrapper, ours pass the whole Tracer.
//
// Heights are 16 bits in a tiled TIFF, which `heightfield` loads as a scene would. Secondary rays of a method start on its own surface.
#include "tests/bench/height.h"

#include "renderer/geometry/tracer.h"
#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "terrain/fields/height.h"
#include "terrain/math/noise.h"
#include "tests/bench/bare_embree.h"
#include "tests/bench/report.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cstdio>
#include <filesystem>
#include <unistd.h>

namespace hoodoo::bench
{
namespace
{

constexpr double kExtent = 12000.0, kRelief = 2400.0;  // metres

std::uint16_t mountain(const Vec2d& p, double cell)
{
    // Octaves down to two samples.
    const double octaves = std::log2(6000.0 / (2.0 * cell));
    const Fractal fractal{octaves, 2.0, 0.48};
    const double crests = ridged(p / 6000.0, 7, fractal).value / 2.0, hills = 0.5 + 0.5 * fbm(p / 9000.0, 8, {4.0, 2.0, 0.5}).value;
    return static_cast<std::uint16_t>(65535.0 * std::clamp(0.15 + 0.7 * crests * hills, 0.0, 1.0));
}

/// A tiled TIFF of size x size samples, written a row of tiles at a time.
std::string write_mountains(int size)
{
    constexpr int tile = 256;
    const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("hoodoo_bench_{}_{}.tif", size, ::getpid());
    OIIO::ImageSpec spec(size, size, 1, OIIO::TypeDesc::UINT16);
    spec.tile_width = spec.tile_height = tile;
    spec.attribute("compression", "none");
    const auto out = OIIO::ImageOutput::create(file.string());
    out->open(file.string(), spec);
    const double cell = kExtent / (size - 1);
    std::vector<std::uint16_t> rows(static_cast<std::size_t>(size) * tile);
    for (int y = 0; y < size; y += tile) {
        const int count = std::min(tile, size - y);
        tbb::parallel_for(0, count, [&](int row) {
            for (int x = 0; x < size; ++x)
                rows[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x)] =
                    mountain(Vec2d(x, size - 1 - y - row) * cell, cell);
        });
        out->write_tiles(0, size, y, y + count, 0, 1, OIIO::TypeDesc::UINT16, rows.data());
    }
    out->close();
    return file.string();
}

std::vector<Shape> load(const std::string& file, int size)
{
    SceneBudget budget;
    std::vector<Problem> problems;
    const Node table =
        parse_toml(fmt::format("file = \"{}\"\ncell = [{:.17g}]\nwhite = {}\n", file, kExtent / (size - 1), kRelief), "<bench>", budget, problems);
    const CatalogueEntry* row = find_in_catalogue("heightfield");
    const Values values = check(row->schema, table, problems);
    std::vector<Shape> shapes;
    shapes.push_back(row->make(values, BuildContext{}));
    return shapes;
}

const Surface& surface_of(const std::vector<Shape>& shapes)
{
    return *std::get<std::unique_ptr<Surface>>(shapes[0]);
}

std::vector<testing::View> views(const Height& height)
{
    const auto over = [&](double x, double y, double lift) { return Vec3d(x, y, height.height({x, y}) + lift); };
    return {{"aerial", Vec3d(-1500.0, -2500.0, 6000.0), Vec3d(6000.0, 6000.0, 500.0), 0.55},
            {"valley", over(3000.0, 2500.0, 25.0), over(8500.0, 8200.0, 100.0), 0.6}};
}

struct Method {
    std::string name;
    std::function<bool(const Ray&, Vec3d&, Vec3d&)> meet;
    std::function<void(const std::vector<Ray>&)> nearest, any;
};

Method of_mesh(const std::string& name, const BareMesh& mesh)
{
    return {name,
            [&mesh](const Ray& ray, Vec3d& p, Vec3d& n) {
                const double t = mesh.intersect(ray, &n);
                p = ray.at(t);
                return t < kInfinity;
            },
            [&mesh](const std::vector<Ray>& rays) {
                for (const Ray& ray : rays) benchmark_keep(mesh.intersect(ray));
            },
            [&mesh](const std::vector<Ray>& rays) {
                for (const Ray& ray : rays) benchmark_keep(mesh.occluded(ray));
            }};
}

Method of_tracer(const Tracer& tracer)
{
    return {"heightfield",
            [&tracer](const Ray& ray, Vec3d& p, Vec3d& n) {
                const TraceHit hit = tracer.intersect(ray);
                if (!hit.valid) return false;
                const Interaction at = tracer.interact(ray, hit);
                p = at.position, n = at.geometric_normal;
                return true;
            },
            [&tracer](const std::vector<Ray>& rays) {
                for (const Ray& ray : rays) benchmark_keep(tracer.intersect(ray).t);
            },
            [&tracer](const std::vector<Ray>& rays) {
                for (const Ray& ray : rays) benchmark_keep(tracer.occluded(ray));
            }};
}

TriangleMesh triangles(const std::vector<Vec3f>& nodes, int size)
{
    TriangleMesh mesh;
    mesh.vertices = nodes;
    mesh.triangles.reserve(2 * static_cast<std::size_t>(size - 1) * static_cast<std::size_t>(size - 1));
    const auto width = static_cast<std::uint32_t>(size);
    for (std::uint32_t j = 0; j + 1 < width; ++j) {
        for (std::uint32_t i = 0; i + 1 < width; ++i) {
            const std::uint32_t a = j * width + i, b = a + 1, c = a + width, d = c + 1;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({b, d, c});
        }
    }
    return mesh;
}

std::vector<Vec3f> nodes_of(const Height& height, int size)
{
    std::vector<Vec3f> nodes;
    const double cell = kExtent / (size - 1);
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) nodes.emplace_back(Vec3d(i * cell, j * cell, height.height({i * cell, j * cell})));
    return nodes;
}

nlohmann::json size_report(int size, bool baselines)
{
    nlohmann::json report;
    const std::string file = write_mountains(size);
    auto start = std::chrono::steady_clock::now();
    const std::vector<Shape> shapes = load(file, size);
    std::filesystem::remove(file);
    const double load_seconds = seconds_since(start);
    start = std::chrono::steady_clock::now();
    const std::unique_ptr<Tracer> tracer = make_embree_tracer(shapes);
    const Surface& surface = surface_of(shapes);
    const double bvh = bvh_megabytes(surface), own = static_cast<double>(surface.info().trace_bytes) / 1e6;
    report["methods"]["heightfield"] = {{"load_seconds", load_seconds},
                                        {"bvh_seconds", seconds_since(start)},
                                        {"patches", surface.info().patches},
                                        {"trace_megabytes", own},
                                        {"bvh_megabytes", bvh},
                                        {"megabytes", own + bvh}};
    std::vector<std::pair<std::string, std::unique_ptr<BareMesh>>> meshes;
    if (baselines) {
        const std::vector<Vec3f> nodes = nodes_of(*surface.height(), size);
        meshes.emplace_back("grid", std::make_unique<BareMesh>(nodes, size, size));
        meshes.emplace_back("triangles", std::make_unique<BareMesh>(triangles(nodes, size)));
        for (const auto& [name, mesh] : meshes) report["methods"][name] = {{"bvh_seconds", mesh->build_seconds}, {"megabytes", mesh->megabytes}};
    }
    std::vector<Method> methods{of_tracer(*tracer)};
    for (const auto& [name, mesh] : meshes) methods.push_back(of_mesh(name, *mesh));
    std::vector<Task> tasks;
    std::vector<std::unique_ptr<RaySets>> keep;
    for (const testing::View& view : views(*surface.height())) {
        for (const Method& method : methods) {
            keep.push_back(std::make_unique<RaySets>(ray_sets(view, 256, method.meet)));
            const RaySets& s = *keep.back();
            tasks.push_back({view.name + "/primary", method.name, s.primary.size(), [&] { method.nearest(s.primary); }});
            tasks.push_back({view.name + "/diffuse", method.name, s.diffuse.size(), [&] { method.nearest(s.diffuse); }});
            tasks.push_back({view.name + "/shadow", method.name, s.shadow.size(), [&] { method.any(s.shadow); }});
        }
    }
    for (std::size_t k = 0; k < keep.size(); k += methods.size()) {
        double cells = 0.0;
        for (const Ray& ray : keep[k]->primary) cells += tracer->intersect(ray).evaluations;
        report["cells_a_primary_ray"][views(*surface.height())[k / methods.size()].name] = cells / static_cast<double>(keep[k]->primary.size());
    }
    const auto rates = measure(tasks);
    for (const Task& task : tasks) report["rays_per_second"][task.group][task.method] = rates.at(task.group + "/" + task.method);
    return report;
}

void print(int size, const nlohmann::json& report)
{
    std::printf("%d x %d\n", size, size);
    for (const auto& [method, facts] : report["methods"].items()) std::printf("  %-12s %s\n", method.c_str(), facts.dump().c_str());
    std::printf("  cells a primary ray %s\n", report["cells_a_primary_ray"].dump().c_str());
    for (const auto& [group, methods] : report["rays_per_second"].items()) {
        std::printf("  %-16s", group.c_str());
        for (const auto& [method, rate] : methods.items()) {
            std::printf("  %s %.0f ns", method.c_str(), 1e9 / rate.get<double>());
            if (method != "heightfield") std::printf(" (ours %.2f times as fast)", methods["heightfield"].get<double>() / rate.get<double>());
        }
        std::printf("\n");
    }
    std::fflush(stdout);
}

}  // namespace

nlohmann::json height_benchmark(bool usual, bool largest)
{
    nlohmann::json report;
    std::vector<int> sizes = usual ? std::vector{1024, 2048, 4096} : std::vector{256, 512};
    if (largest) sizes.push_back(16384);
    for (const int size : sizes) {
        nlohmann::json r = size_report(size, size <= 4096);
        print(size, r);
        report[std::to_string(size)] = std::move(r);
    }
    // How the time a ray grows with the size, the view being the same.
    const std::string first = std::to_string(sizes.front());
    for (const int size : sizes) {
        for (const auto& [group, methods] : report[std::to_string(size)]["rays_per_second"].items()) {
            const double ratio = report[first]["rays_per_second"][group]["heightfield"].get<double>() / methods["heightfield"].get<double>();
            report["time_against_smallest"][std::to_string(size)][group] = ratio;
        }
    }
    std::printf("time a ray against %s: %s\n", first.c_str(), report["time_against_smallest"].dump().c_str());
    return report;
}

}  // namespace hoodoo::bench
