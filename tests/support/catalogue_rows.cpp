// Parameters as a scene would write them, for one small instance of each representation.

#include "tests/support/catalogue_rows.h"

#include "renderer/scene/toml_text.h"
#include "terrain/math/hash.h"
#include "tests/support/mesh_surface.h"
#include "tests/support/terrain_files.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo::testing
{
namespace
{

/// Layers without water, or with it.
std::string small_layers(const Vec3d& s, const std::string& more)
{
    return fmt::format("bedrock = \"{}\"\nsand = \"{}\"\nbedrock_offset = {:.17g}\ncell = 0.5\norigin = [{:.17g}, {:.17g}]\n{}",
                       layer_path("bedrock"), layer_path("sand"), s.z, s.x, s.y, more);
}

std::string vector_text(const Vec3d& v)
{
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x, v.y, v.z);
}

std::string small_hills(const std::string& kind, const Vec3d& shift)
{
    return fmt::format(
        "kind = \"{}\"\norigin = {}\ncentre = [{:.17g}, {:.17g}]\nextent = 6.0\nrelief = 3.0\nwavelength = 5.0\noctaves = 4\npatch = 0.5\n"
        "growth = 0.0\nlod = false\n",
        kind, vector_text(shift), shift.x, shift.y);
}

/// A plateau with a tunnel through it, a cave and an arch: walls, ceilings and thin parts. Moved as a whole.
std::string carved_block(const Vec3d& shift, const std::string& more)
{
    const auto at = [&](double x, double y, double z) { return vector_text(Vec3d(x, y, z) + shift); };
    return fmt::format(
        "columns = [14, 12]\ncell = 0.5\nunit = 0.015625\norigin = {}\n{}\n"
        "[[layer]]\nshape = \"flat\"\ntop = 4.0\n[[layer]]\nshape = \"flat\"\nthickness = 0.5\nmaterial = \"sand\"\n"
        "[[edit]]\ntool = \"sweep\"\npoints = [{}, {}]\nradius = [1.1]\n"
        "[[edit]]\ntool = \"sweep\"\npoints = [{}]\nradius = [1.6]\n"
        "[[edit]]\ntool = \"sweep\"\npoints = [{}, {}]\nradius = [0.9, 1.4]\n",
        vector_text(shift), more, at(-1, 2.6, 2.2), at(8, 3.4, 2.4), at(5.5, 4.8, 4.6), at(1.6, -1, 4.4), at(2.2, 7, 4.8));
}

/// One node of a tree.
std::string node(const std::string& name, const std::string& kind, const std::string& rest)
{
    return fmt::format("[[node]]\nname = \"{}\"\nkind = \"{}\"\n{}\n", name, kind, rest);
}

/// Every primitive and every operator once. Moved as a whole.
std::string every_node(const Vec3d& shift)
{
    const auto at = [&](double x, double y, double z) { return vector_text(Vec3d(x, y, z) + shift); };
    return "patch = 0.4\n" + node("ball", "point", fmt::format("at = {}\nradius = 1.3", at(0, 0, 1))) +
           node("bar", "segment", fmt::format("points = [{}, {}]\nradius = [0.9, 0.4]\nmaterial = \"sand\"", at(-2, 0.3, 0.2), at(2.5, 0.8, 0.6))) +
           node("snake", "curve",
                fmt::format("points = [{}, {}, {}, {}]\nradius = [0.5, 0.8, 0.4, 0.6]", at(2, -2, 0), at(3, 0, 1.4), at(1, 2, 1.8), at(-2, 2, 0.5))) +
           node("plate", "disc", fmt::format("centre = {}\nnormal = [0.2, 0.1, 1]\nextent = 2.2\nradius = 0.35", at(0, 0, -0.8))) +
           node("star", "polygon",
                fmt::format("points = [{}, {}, {}, {}, {}]\nradius = 0.3", at(-1, -3, -1), at(2, -3, -1), at(0.7, -3, 0.4), at(1, -3, 2),
                            at(-2, -3, 2))) +
           node("tunnel", "sweep",
                fmt::format("points = [{}, {}, {}]\nprofile = [-0.5, -0.4, 0.5, -0.4, 0.6, 0.3, 0, 0.7, -0.6, 0.3]\nscale = [1, 0.8, 1.1]",
                            at(-3, -1, 0.9), at(0, 0.2, 1.1), at(3, 0.4, 1.2))) +
           node("core", "blend", "of = [\"ball\", \"bar\", \"snake\"]\nwidth = 0.25") +
           node("bent", "warp",
                fmt::format("of = \"core\"\n[[node.flow]]\nkind = \"vortex\"\ncentre = {}\naxis = [0, 0.3, 1]\nradius = 2.5\nstrength = 0.7",
                            at(0.5, 0.5, 0.5))) +
           node("rough", "noise", fmt::format("of = \"bent\"\namplitude = 0.12\nwavelength = 1.1\noctaves = 2\norigin = {}", at(0, 0, 0))) +
           node("lens", "intersection", fmt::format("of = [\"plate\", \"well\"]\nwidth = 0.1")) +
           node("well", "point", fmt::format("at = {}\nradius = 2.0", at(0.4, 0.2, -1.6))) +
           node("all", "union", "of = [\"rough\", \"lens\", \"star\"]") + node("solid", "difference", "of = [\"all\", \"tunnel\"]\nwidth = 0.05");
}

std::string land_area(const Vec3d& shift)
{
    return fmt::format("centre = [{:.17g}, {:.17g}]\nextent = 6.0\npatch = 0.5\ngrowth = 0.0\n", shift.x, shift.y);
}

/// Every landform and every operator, the tree moved as a whole by its own last node.
std::string every_landform(const Vec3d& shift)
{
    return land_area(shift) + node("plain", "flat", "height = 0.5") +
           node("hills", "noise", "noise = \"billow\"\nrelief = 0.6\nwavelength = 3.0\noctaves = 3") +
           node("moor", "noise", "relief = 0.8\nwavelength = 2.0\noctaves = 2\nheight = 1.0\nat = [-3, 3]\nradius = 2.5\ncore = 0.5\npower = 2") +
           node("hill", "point", "at = [2, 2, 1.5]\nradius = 2.2\nprofile = [0, 1.0, 0.8, 0.4, 2.0, 0]") +
           node("spike", "point", "at = [3, -2, 0.5]\nradius = 1.5\nprofile = [0, 1.5, 1.2, 0]\nsharp = true") +
           node("ditch", "segment",
                "points = [[-4, -3, 0.2], [1, -2, -0.4]]\nradius = 1.2\ncore = 0.2\nrough = 0.1\nrough_wavelength = 0.7\nrough_octaves = 2") +
           node("river", "curve",
                "points = [[-5, 0, 0.4], [-2, 1, 0.2], [0, -1, 0.1], [2, 0.5, -0.2], [5, -1, -0.5]]\nradius = 1.1\nprofile = [0, 0, 0.3, 0.02, 1.1, "
                "0.4]") +
           node("wall", "curve", "points = [[-1, 4, 1], [0, 2.5, 1.4], [1, 4.5, 1.2]]\nsmooth = false\nradius = 0.9\ncore = 0.3\njoint = 0.2") +
           node("two", "blend", "of = [\"hill\", \"wall\"]\nweight = \"united\"") + node("heap", "blend", "of = [\"moor\", \"two\", \"spike\"]") +
           node("ground", "add", "of = [\"plain\", \"hills\"]") + node("land", "replace", "of = [\"ground\", \"heap\"]") +
           node("again", "move", "of = \"two\"\nscale = 0.7\nturn = \"130 deg\"\nshift = [-2, -4, 0.3]") +
           node("raised", "max", "of = [\"land\", \"again\"]") + node("cut", "min", "of = [\"raised\", \"ditch\"]") +
           node("wet", "inset", "of = [\"cut\", \"river\"]") + node("bent", "warp", "of = \"wet\"\namplitude = 0.3\nwavelength = 3.0\noctaves = 2") +
           node("all", "move", fmt::format("of = \"bent\"\nshift = {}", vector_text(shift)));
}

/// A hill, a road and two local landforms run together, on rugged samples.
std::string landforms_on(const std::string& base, const Vec3d& shift)
{
    const auto at = [&](double x, double y, double z) { return vector_text(Vec3d(x, y, z) + shift); };
    return fmt::format("centre = [{:.17g}, {:.17g}]\nextent = 7.0\npatch = 0.5\ngrowth = 0.0\n", shift.x + 8, shift.y + 8) +
           node("ground", "terrain", fmt::format("terrain = \"{}\"", base)) +
           node("road", "curve", fmt::format("points = [{}, {}, {}]\nradius = 1.5\ncore = 0.6", at(2, 3, 5), at(8, 9, 6), at(14, 8, 4))) +
           node("cone", "point", fmt::format("at = {}\nradius = 3.0\nprofile = [0, 3, 3, 0]\nsharp = true", at(11, 12, 4))) +
           node("lip", "point", fmt::format("at = {}\nradius = 1.0", at(11, 12, 5.5))) + node("crater", "inset", "of = [\"cone\", \"lip\"]") +
           node("land", "max", "of = [\"ground\", \"crater\"]") + node("top", "replace", "of = [\"land\", \"road\"]");
}

/// Hills written with patches of rugged samples, on a plain.
std::string landforms_of_patches(const std::string& coarse, const std::string& exemplar, const Vec3d& shift)
{
    return fmt::format("centre = [{:.17g}, {:.17g}]\nextent = 7.0\npatch = 0.5\ngrowth = 0.0\n", shift.x, shift.y) +
           node("plain", "flat", fmt::format("height = {:.17g}", shift.z)) +
           node("detail", "dictionary",
                fmt::format("terrain = \"{}\"\nexemplar = \"{}\"\nspacing = 2.0\ndetail = 0.3\natoms = 12\nterms = 3\narea = [{:.17g}, {:.17g}, "
                            "{:.17g}, {:.17g}]",
                            coarse, exemplar, shift.x - 5, shift.y - 5, shift.x + 5, shift.y + 5)) +
           node("land", "replace", "of = [\"plain\", \"detail\"]");
}

/// The carved block with a cave through its wall. Moved as a whole.
std::string caves_in(const std::string& base, const Vec3d& shift)
{
    const auto at = [&](double x, double y, double z) { return vector_text(Vec3d(x, y, z) + shift); };
    return fmt::format(
        "patch = 0.6\n[[node]]\nname = \"ground\"\nkind = \"terrain\"\nterrain = \"{}\"\n[[node]]\nname = \"gallery\"\nkind = \"curve\"\n"
        "points = [{}, {}, {}]\nradius = [0.6, 1.0, 0.5]\n[[node]]\nname = \"hall\"\nkind = \"point\"\nat = {}\nradius = 1.3\n"
        "[[node]]\nname = \"caves\"\nkind = \"blend\"\nof = [\"gallery\", \"hall\"]\nwidth = 0.2\n"
        "[[node]]\nname = \"karst\"\nkind = \"difference\"\nof = [\"ground\", \"caves\"]\n",
        base, at(-1, 4.5, 3.0), at(3, 4.0, 1.5), at(6, 1.0, 3.5), at(4.5, 2.5, 2.2));
}

}  // namespace

TriangleMesh flattened(const Instances& instances)
{
    TriangleMesh out;
    out.material = instances.material;
    if (!instances.instances.empty()) out.origin = instances.instances[0].position;
    for (const Instance& instance : instances.instances) {
        const TriangleMesh& mesh = instances.meshes[instance.mesh];
        const auto first = static_cast<std::uint32_t>(out.vertices.size());
        const Imath::Quatd turn = Imath::Quatd(instance.rotation.r, Vec3d(instance.rotation.v)).normalized();
        for (const Vec3f& v : mesh.vertices)
            out.vertices.emplace_back(rotated(turn, mesh.origin + Vec3d(v)) * instance.scale + instance.position - out.origin);
        for (const Vec3f& n : mesh.normals) out.normals.emplace_back(rotated(turn, Vec3d(n)));
        for (const auto& t : mesh.triangles) out.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return out;
}

const std::vector<RowInstance>& row_instances()
{
    static const std::vector<RowInstance> rows{
        {"plane", "plane",
         [](const Vec3d& s) { return fmt::format("point = {}\nnormal = [0.1, -0.2, 1.0]\nextent = 20.0\n", vector_text(Vec3d(1, 2, 3) + s)); },
         0.7},  // a disc in its box
        {"mesh", "mesh", [](const Vec3d& s) { return fmt::format("file = \"{}\"\ntranslate = {}\n", mesh_path(), vector_text(s)); }},
        {"convolution", "convolution_sphere", [](const Vec3d& s) { return carved_block(s, "intersector = \"sphere\"\nsigma_cells = 0.8"); }},
        {"convolution", "convolution_exact", [](const Vec3d& s) { return carved_block(s, "intersector = \"exact\""); }},
        {"convolution", "convolution_cut_sphere",
         [](const Vec3d& s) { return carved_block(s, "intersector = \"sphere\"\nborder = \"cut\"\nsigma_cells = 1.5"); }},
        {"convolution", "convolution_cut_exact",
         [](const Vec3d& s) { return carved_block(s, "intersector = \"exact\"\nborder = \"cut\"\nsigma_cells = 1.5"); }},
        {"warped", "warped_plane",
         [](const Vec3d& s) {
             return fmt::format(
                 "base = \"plane\"\npatch = 1.0\nregion_min = {}\nregion_max = {}\n[[flow]]\nkind = \"curl\"\nwavelength = 10.0\norigin = {}\n"
                 "strength = 0.3\n",
                 vector_text(Vec3d(-4, -4, -2) + s), vector_text(Vec3d(6, 6, 8) + s), vector_text(s));
         },
         0.9},
        {"warped", "warped_convolution",
         [](const Vec3d& s) {
             return fmt::format(
                 "base = \"convolution_cut_sphere\"\npatch = 0.7\n[[flow]]\nkind = \"vortex\"\ncentre = {}\naxis = [0, 1, 0.2]\nradius = 3.0\n",
                 vector_text(Vec3d(3, 3, 3) + s));
         }},
        {"warped", "warped_twice",
         [](const Vec3d& s) {
             return fmt::format(
                 "base = \"warped_plane\"\npatch = 1.0\nintensity_close = 1.2\nregion_min = {}\nregion_max = {}\n[[flow]]\nkind = \"bulge\"\ncentre "
                 "= {}\nradius = 3.0\n"
                 "strength = 0.4\n",
                 vector_text(Vec3d(-2, -2, -2) + s), vector_text(Vec3d(4, 4, 8) + s), vector_text(Vec3d(1, 1, 2.5) + s));
         },
         0.9},
        {"canyon", "canyon",
         [](const Vec3d& s) {
             return fmt::format(
                 "origin = {}\ncentre = {}\ncell = 4.0\nheight = 4.0\nextent = 5.0\npatch = 0.5\ngrowth = 0.0\noctaves = 3\nlod = false\n",
                 vector_text(s), vector_text(Vec3d(2, 1, 2) + s));
         },
         0.9},
        {"canyon", "canyon_lifted",
         [](const Vec3d& s) {
             return fmt::format(
                 "origin = {}\ncentre = {}\ncell = 4.0\nheight = 4.0\nextent = 4.0\npatch = 0.6\ngrowth = 0.0\noctaves = 2\nlod = false\n"
                 "lift = 0.3\nlift_wavelength = 1.0\n",
                 vector_text(s), vector_text(Vec3d(2, 1, 2) + s));
         },
         0.9},
        {"breaking_wave", "breaking_wave",
         [](const Vec3d& s) {
             return fmt::format(
                 "origin = {}\ncentre = {}\nextent = 7.0\npatch = 0.4\ngrowth = 0.0\ntime = 4.0\n"
                 "[[wave]]\ncentre = [20, 0]\nsteepening = 5.0\npeel = 3.0\npeel_width = 2.0\nintensity = 4.8\n"
                 "[[swell]]\nwavelength = 6.0\nheight = 0.2\nheading_deg = 200\nphase_deg = 40\n",
                 vector_text(s), vector_text(s));
         },
         0.9},
        {"voxels", "voxels", [](const Vec3d& s) { return fmt::format("file = \"{}\"\ncell = 0.5\norigin = {}\n", voxel_path(), vector_text(s)); }},
        {"voxels", "voxels_of_layers",
         [](const Vec3d& s) {
             return fmt::format("base = \"convolution_cut_exact\"\ncell = 0.4\nregion_min = {}\nregion_max = {}\n", vector_text(Vec3d(0, -1, 1) + s),
                                vector_text(Vec3d(8, 6, 6) + s));
         }},
        {"heightfield", "heightfield",
         [](const Vec3d& s) {
             return fmt::format("file = \"{}\"\nwhite = 12.0\ncell = [0.5, 0.4]\norigin = {}\nsmooth = true\n", heights_path(), vector_text(s));
         },
         0.95},
        {"elevation", "elevation_fbm", [](const Vec3d& s) { return small_hills("fbm", s); }, 0.9},
        {"elevation", "elevation_ridged", [](const Vec3d& s) { return small_hills("ridged", s); }, 0.9},
        {"elevation", "elevation_billow", [](const Vec3d& s) { return small_hills("billow", s); }, 0.9},
        {"elevation", "elevation_multifractal", [](const Vec3d& s) { return small_hills("multifractal", s); }, 0.9},
        {"landforms", "landforms", every_landform, 0.9},
        {"landforms", "landforms_on_heights", [](const Vec3d& s) { return landforms_on("heightfield", s); }, 0.9},
        {"landforms", "landforms_of_patches", [](const Vec3d& s) { return landforms_of_patches("elevation_billow", "heightfield", s); }, 0.9},
        {"layers", "layers", [](const Vec3d& s) { return small_layers(s, ""); }, 0.95},
        {"layers", "layers_with_water", [](const Vec3d& s) { return small_layers(s, fmt::format("water = \"{}\"\n", layer_path("water"))); }, 0.9},
        {"implicit", "implicit", every_node},
        {"implicit", "implicit_caves", [](const Vec3d& s) { return caves_in("convolution_cut_sphere", s); }},
        {"implicit", "implicit_caves_in_voxels", [](const Vec3d& s) { return caves_in("voxels_of_layers", s); }},
        {"rock_pile", "rock_pile",
         [](const Vec3d& s) {
             return fmt::format("base = {}\nsize = [3.4, 3.0, 1.6]\nrocks_per_tile = 12\nrock_detail = 3\nform = \"bed\"\n", vector_text(s));
         }},
        {"cracked", "cracked_layers",
         [](const Vec3d& s) {
             return fmt::format(
                 "n = 40\nlambda = 0.25\npatch = 0.5\nzero = {:.17g}\none = {:.17g}\n[[ground]]\ntype = \"convolution\"\ncolumns = [40, 36]\ncell = "
                 "0.25\n"
                 "unit = 0.015625\norigin = {}\n[[ground.layer]]\nshape = \"flat\"\ntop = 3.0\n",
                 s.z, s.z + 10.0, vector_text(s));
         },
         0.9},
        {"cracked", "cracked_elevation",
         [](const Vec3d& s) {
             return fmt::format(
                 "n = 30\nlambda = 0.25\npatch = 0.5\nzero = {:.17g}\none = {:.17g}\nregion_min = [{:.17g}, {:.17g}]\nregion_max = [{:.17g}, "
                 "{:.17g}]\n[[ground]]\ntype = \"elevation\"\n{}",
                 s.z - 3.0, s.z + 3.0, s.x - 5, s.y - 4, s.x + 5, s.y + 4, small_hills("fbm", s));
         },
         0.9},
        {"cracked", "cracked_heightfield",
         [](const Vec3d& s) {
             return fmt::format(
                 "n = 60\nlambda = 0.2\npatch = 0.5\npsi = 0.6\n[[ground]]\ntype = \"heightfield\"\nfile = \"{}\"\nwhite = 12.0\ncell = [0.5, "
                 "0.4]\norigin = {}\n",
                 heights_path(), vector_text(s));
         },
         0.9},
        {"cracked", "cracked_curled",
         [](const Vec3d& s) {
             return fmt::format(
                 "n = 24\nlambda = 0.15\npatch = 0.5\ncurl = 0.5\nzero = {:.17g}\none = {:.17g}\nregion_min = [{:.17g}, {:.17g}]\nregion_max = "
                 "[{:.17g}, {:.17g}]\n[[ground]]\ntype = \"plane\"\npoint = {}\nnormal = [0.2, 0.1, 1.0]\nextent = 20.0\n",
                 s.z, s.z + 6.0, s.x - 4, s.y - 3, s.x + 6, s.y + 5, vector_text(Vec3d(1, 2, 3) + s));
         },
         0.9},
        {"cracked", "cracked_plane",
         [](const Vec3d& s) {
             return fmt::format(
                 "n = 30\nlambda = 0.2\npatch = 0.5\nregion_min = [{:.17g}, {:.17g}]\nregion_max = [{:.17g}, {:.17g}]\n[[ground]]\ntype = "
                 "\"plane\"\npoint = {}\n"
                 "normal = [0.3, -0.2, 1.0]\nextent = 20.0\n",
                 s.x - 4, s.y - 3, s.x + 6, s.y + 5, vector_text(Vec3d(1, 2, 3) + s));
         },
         0.9},
    };
    return rows;
}

const Surface& BuiltRow::surface() const
{
    if (mesh) return *mesh;
    return *std::get<std::unique_ptr<Surface>>(*shape);
}

BuiltRow build_row(const RowInstance& instance, const Vec3d& shift)
{
    const CatalogueEntry* entry = find_in_catalogue(instance.row);
    if (!entry) throw Error(ErrorKind::internal, "no row " + instance.row);
    SceneBudget budget;
    std::vector<Problem> problems;
    const Node table = parse_toml(instance.text(shift), "<row>", budget, problems);
    const Values values = check(entry->schema, table, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    BuildContext context;
    context.name = instance.name;
    context.seed = hash_name(1, instance.name);
    context.view = instance.view;
    // A base is the instance of that name, moved alike.
    context.base = [&](const std::string& name, const Source&) -> std::shared_ptr<const Surface> {
        const auto& rows = row_instances();
        const auto base = std::find_if(rows.begin(), rows.end(), [&](const RowInstance& row) { return row.name == name; });
        if (base == rows.end()) throw Error(ErrorKind::internal, "no instance " + name);
        return std::move(std::get<std::unique_ptr<Surface>>(*build_row(*base, shift).shape));
    };
    BuiltRow built;
    built.shape = std::make_unique<Shape>(entry->make(values, context));
    if (const auto* instances = std::get_if<Instances>(built.shape.get())) {
        built.flat = std::make_unique<TriangleMesh>(flattened(*instances));
        built.mesh = std::make_unique<MeshSurface>(*built.flat);
    }
    if (const auto* mesh = std::get_if<TriangleMesh>(built.shape.get())) built.mesh = std::make_unique<MeshSurface>(*mesh);
    return built;
}

}  // namespace hoodoo::testing
