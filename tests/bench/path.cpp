// A whole path on one thread: Lambert 0.5, delta sun, constant sky, five scattering events, 512 x 512. The same ground as a convolution terrain and
// as a triangle mesh of about 2.1 million triangles, both through the product's own scene files; and a plain elevation grid of 1025 x 1025 samples,
// 2,097,152 triangles, as terrains usually come. Rates are by processor time, so that a busy machine changes them little.
//
// Error of 64 samples: of two pictures with independent samples, the relative root mean square difference over all pixels by sqrt 2, which is the
// error against a perfect reference, at the size that is spoken of (a smaller picture of the same view has larger pixels and so more noise in each).
// From it, by the 1/sqrt(n) law, the processor seconds to an error of one percent.

#include "tests/bench/path.h"

#include "renderer/render.h"
#include "terrain/march/exact_cells.h"
#include "terrain/math/noise.h"
#include "tests/bench/polygonise.h"
#include "tests/bench/profile.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>

namespace hoodoo::bench
{
namespace
{

const char* const kFrame = R"(
version = 1
[camera]
eye = [-150, -120, 330]
target = [470, 400, 60]
hfov = "52 deg"
[film]
width = 512
height = 512
filter = "box"
[render]
spp = 16
max_depth = 5
[light.sun]
type = "sun"
elevation = "40 deg"
azimuth = "200 deg"
shape = "delta"
irradiance = { acescg = [900, 850, 800] }
[light.sky]
type = "constant"
radiance = { acescg = [60, 70, 90] }
[material.bedrock]
procedural = "plain"
albedo = { grey = 0.5 }
roughness = 0.0
)";

const char* const kTerrain = R"(
[terrain.ground]
type = "convolution"
cell = "1 m"
sigma_cells = 2.0
[[terrain.ground.layer]]
shape = "fractal"
kind = "ridged"
height = 110.0
relief = 100.0
wavelength = 260.0
octaves = 7.0
warp = 20.0
warp_wavelength = 90.0
[[terrain.ground.layer]]
shape = "canyon"
measure = "cut"
points = [[100, -100, 20], [300, 300, 24], [700, 380, 30], [900, 900, 40]]
rim = 210.0
floor_width = 40.0
width = 190.0
warp = 30.0
beds = 9.0
)";

void write_ply(const TriangleMesh& mesh, const std::string& path)
{
    std::ofstream out(path, std::ios::binary);
    out << fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n"
        "property list uchar uint vertex_indices\nend_header\n",
        mesh.vertices.size(), mesh.triangles.size());
    for (const Vec3f& v : mesh.vertices) out.write(reinterpret_cast<const char*>(&v), sizeof v);
    for (const auto& t : mesh.triangles) {
        out.put(3);
        out.write(reinterpret_cast<const char*>(t.data()), sizeof t);
    }
}

double seconds_of(const std::function<void()>& work)
{
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string part_of(const std::string& function)
{
    const auto has = [&](const char* word) { return function.find(word) != std::string::npos; };
    if (has("libembree") || has("Tracer") || has("ExactCells") || has("filter_") || has("first_crossing") || has("part_") || has("CellTile") ||
        has("SphereBricks"))
        return "intersection";
    if (has("Sampler") || has("owen") || has("sobol") || has("Filter::")) return "sampling";
    if (has("interact") || has("ConvolutionField") || has("ColumnsAround") || has("refine_crossing") || has("visible") || has("appearance") ||
        has("Look") || has("procedur") || has("noise") || has("Lambert") || has("CosineLobe") || has("RoughDiffuse") || has("trace_path") ||
        has("next_event") || has("make_vertex") || has("Sun") || has("Sky"))
        return "shading";
    return "other";
}

/// Root mean square difference over the mean of the reference, all channels.
double relative_rmse(const Image& image, const Image& reference)
{
    double sum = 0.0, mean = 0.0;
    std::size_t n = 0;
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>&a = image.find(channel)->pixels, &b = reference.find(channel)->pixels;
        for (std::size_t i = 0; i < a.size(); ++i, ++n) {
            sum += (static_cast<double>(a[i]) - b[i]) * (static_cast<double>(a[i]) - b[i]);
            mean += b[i];
        }
    }
    return std::sqrt(sum / static_cast<double>(n)) / (mean / static_cast<double>(n));
}

nlohmann::json measure_scene(const LoadedScene& loaded, bool full)
{
    RenderOptions options;
    options.width = options.height = full ? 512 : 128;
    options.spp = full ? 16 : 4;
    options.threads = 1;
    const double samples = static_cast<double>(*options.width) * *options.height * *options.spp;
    const auto cpu_seconds = [&] {
        const std::clock_t start = std::clock();
        render(loaded, options);
        return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    };
    const double cpu = std::min(cpu_seconds(), cpu_seconds());
    const double one = std::min(seconds_of([&] { render(loaded, options); }), seconds_of([&] { render(loaded, options); }));
    options.threads = 2;
    const double two = std::min(seconds_of([&] { render(loaded, options); }), seconds_of([&] { render(loaded, options); }));
    options.threads = 1;
    const auto shares = profile([&] { render(loaded, options); }, part_of);

    options.threads = 0;
    options.spp = 64;
    options.seed = 1;
    const Image reference = render(loaded, options);
    options.seed = 2;
    const double rmse = relative_rmse(render(loaded, options), reference) / std::sqrt(2.0);
    const double rate = samples / cpu;
    return {{"samples_per_cpu_second", rate},
            {"two_threads_over_one", one / two},
            {"rmse_at_64", rmse},
            {"cpu_seconds_to_1_percent", static_cast<double>(*options.width) * *options.height * 64.0 * (rmse / 0.01) * (rmse / 0.01) / rate},
            {"shares", shares}};
}

nlohmann::json measure_mesh(const TriangleMesh& mesh, bool full)
{
    const std::filesystem::path folder = std::filesystem::absolute("out/bench");
    std::filesystem::create_directories(folder);
    const std::filesystem::path ply = folder / "path.ply", scene_file = folder / "path.toml";
    write_ply(mesh, ply.string());
    std::ofstream(scene_file) << kFrame << "[terrain.ground]\ntype = \"mesh\"\nfile = \"path.ply\"\nmaterial = \"bedrock\"\nnormals = \"flat\"\n";
    const LoadedScene triangles = load_scene(scene_file.string(), false);
    nlohmann::json facts = measure_scene(triangles, full);
    facts["triangles"] = mesh.triangles.size();
    facts["build_seconds"] = triangles.build_seconds;
    return facts;
}

/// n x n samples a metre apart, hills of 200 m: two triangles a cell.
TriangleMesh elevation_grid(std::uint32_t n)
{
    TriangleMesh mesh;
    const Fractal fractal{8.0, 2.0, 0.45};
    const double scale = 100.0 / fbm_bound(kNoise3Bound, fractal).value;
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i)
            mesh.vertices.emplace_back(i, j, static_cast<float>(100.0 + 2.0 * scale * fbm(Vec3d(i / 300.0, j / 300.0, 0.5), 7u, fractal).value));
    for (std::uint32_t j = 0; j + 1 < n; ++j)
        for (std::uint32_t i = 0; i + 1 < n; ++i) {
            const std::uint32_t k = j * n + i;
            mesh.triangles.push_back({k, k + 1, k + n + 1});
            mesh.triangles.push_back({k, k + n + 1, k + n});
        }
    return mesh;
}

}  // namespace

nlohmann::json path_benchmark(bool full)
{
    const std::string size = full ? "columns = [1024, 768]" : "columns = [160, 128]";
    std::string text = std::string(kFrame) + kTerrain;
    text.replace(text.find("cell = \"1 m\""), 0, size + "\n");
    const LoadedScene direct = load_scene(text, true);
    nlohmann::json report;
    report["convolution"] = measure_scene(direct, full);
    report["convolution"]["build_seconds"] = direct.build_seconds;

    // The same ground as triangles; the spacing is scaled once towards the wanted number.
    const auto& surface = std::get<std::unique_ptr<Surface>>(direct.scene->shapes()[0]);
    const auto& field = dynamic_cast<const ConvolutionField&>(*surface->field());
    const auto cells = make_exact_cells(field);
    const double wanted = full ? 2.1e6 : 5e4;
    double spacing = 1.6;
    TriangleMesh mesh = polygonise(field, *cells, spacing);
    spacing *= std::sqrt(static_cast<double>(mesh.triangles.size()) / wanted);
    mesh = polygonise(field, *cells, spacing);
    report["mesh"] = measure_mesh(mesh, full);
    report["elevation_grid"] = measure_mesh(elevation_grid(full ? 1025 : 161), full);
    for (const auto& [name, facts] : report.items()) std::printf("%-12s %s\n", name.c_str(), facts.dump().c_str());
    return report;
}

}  // namespace hoodoo::bench
