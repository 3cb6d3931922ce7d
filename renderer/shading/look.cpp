// What a material's table says, turned into colour, roughness and normal at a point: a procedure or images, projected, varied, bumped.
//
// Colours are converted to the rendering space once, when the look is made. The conversion of an image's primaries is linear, so its nine numbers
// are found by converting three colours, and it is applied after filtering. The triplanar blend (Peytavie2009) weights three lookups by the geometric
// normal; solid procedures need none. Slopes that the footprint hides become roughness: the standard deviation of slopes is the parameter of the
// rough diffuse model, and variances add (Olano2010).
// Missing: per-projection rotation; normal maps under "uv", which need a tangent frame that an Interaction does not carry.

#include "renderer/shading/look.h"

#include "renderer/shading/mask.h"
#include "renderer/shading/procedural.h"
#include "renderer/shading/texture.h"
#include "renderer/shading/triplanar.h"
#include "terrain/math/hash.h"

#include <algorithm>
#include <optional>

namespace hoodoo
{

namespace
{

const std::vector<std::string> kTextureSpaces = {"srgb", "lin_rec709", "acescg"};

std::size_t procedure_index(const std::string& name)
{
    const auto& names = procedure_names();
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

Procedure procedure_for(const std::string& name)
{
    const std::size_t i = procedure_index(name);
    return i < procedure_names().size() ? static_cast<Procedure>(i) : Procedure::plain;
}

Vec3f converted(const ColorConverter& convert, const ColorValue& color)
{
    return convert ? convert(color) : Vec3f(color.rgb);
}

Vec3f inside_unit_cube(const Vec3f& c)
{
    return Vec3f(std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f));
}

/// Columns: what the unit colours of a linear space become.
struct ColorMatrix {
    Vec3f red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1};
    Vec3f apply(const Vec3f& c) const { return red * c.x + green * c.y + blue * c.z; }
};

ColorMatrix matrix_from(const ColorConverter& convert, const std::string& space)
{
    return {converted(convert, {Vec3d(1, 0, 0), space}), converted(convert, {Vec3d(0, 1, 0), space}), converted(convert, {Vec3d(0, 0, 1), space})};
}

/// The default roughness of each procedure, in the order of the enumeration: the root mean square slope of relief too fine to be drawn.
constexpr std::array<float, 6> kRoughness = {0.0f, 0.30f, 0.30f, 0.35f, 0.40f, 0.0f};

struct Settings {
    Procedure procedure = Procedure::plain;
    Palette palette{};
    std::optional<Vec3f> mean;  ///< what a procedure's mean is scaled to
    float roughness = 0.0f;
    float coat = 0.0f;
    double contrast = 1.0;
    double variation = 0.0;
    double tint = 0.0;
    double bump = 1.0;
    double scale = 1.0;  ///< metres a repeat
    double exponent = 8.0;
    bool uv = false;
    std::uint64_t seed = 0;
    ColorMatrix albedo_matrix;
    std::unique_ptr<Texture> albedo, roughness_map, normal_map;
};

class MaterialLook final : public Look
{
public:
    explicit MaterialLook(Settings settings) : s_(std::move(settings)) { match_mean(); }

    Appearance appearance(const Interaction& at, double footprint) const override
    {
        Appearance a = in_texture_space(at, footprint);
        if (at.instance != 0 && s_.tint > 0.0) a.albedo = inside_unit_cube(a.albedo * instance_tint(at.look_seed));
        return a;
    }

private:
    /// On a turned instance the axes of the projections turn with it: normals go into its space and come back.
    Appearance in_texture_space(const Interaction& at, double footprint) const
    {
        if (at.texture_to_world.v == Vec3d(0.0)) return untinted(at, footprint);
        const Imath::Quatd to_texture = at.texture_to_world.inverse();
        Interaction turned = at;
        turned.geometric_normal = rotated(to_texture, at.geometric_normal);
        turned.shading_normal = rotated(to_texture, at.shading_normal);
        Appearance a = untinted(turned, footprint);
        a.normal = rotated(at.texture_to_world, a.normal);
        return a;
    }

    /// Stones of one place differ in brightness more than in hue: a grey factor, and a quarter of it between warm and cold.
    Vec3f instance_tint(std::uint32_t seed) const
    {
        const double grey = 1.0 + s_.tint * (2.0 * unit_real(hash_cell(s_.seed, seed, 0)) - 1.0);
        const double warm = 0.25 * s_.tint * (2.0 * unit_real(hash_cell(s_.seed, seed, 1)) - 1.0);
        return Vec3f(static_cast<float>(grey * (1.0 + warm)), static_cast<float>(grey), static_cast<float>(grey * (1.0 - warm)));
    }

    Appearance untinted(const Interaction& at, double footprint) const
    {
        Pattern pattern = evaluate_procedure(s_.procedure, s_.palette, s_.seed, at, footprint);
        Appearance a;
        a.albedo = s_.albedo ? s_.albedo_matrix.apply(projected(*s_.albedo, at, footprint)) : contrasted(pattern.albedo);
        if (s_.variation > 0.0) a.albedo *= static_cast<float>(1.0 + s_.variation * large_scale_variation(s_.seed, at.texture_point, footprint));
        a.albedo = inside_unit_cube(a.albedo);

        const double rough = s_.roughness_map ? projected(*s_.roughness_map, at, footprint).x : s_.roughness;
        const double roughness2 = rough * rough + pattern.lost_variance * s_.bump * s_.bump + at.slope_variance;
        a.roughness = static_cast<float>(std::min(std::sqrt(roughness2), 1.0));

        Vec3d relief = pattern.relief;
        if (s_.normal_map) relief = projected_slopes(at, footprint);
        a.coat = s_.coat;
        a.normal =
            relief == Vec3d(0.0) || s_.bump == 0.0 ? at.shading_normal : bumped_normal(at.shading_normal, relief * s_.bump, at.geometric_normal);
        return a;
    }

    /// The procedure's mean over many places and directions, and from it contrast and tint.
    void match_mean();

    Vec3f contrasted(const Vec3f& c) const { return (mean_ + (c - mean_) * static_cast<float>(s_.contrast)) * tint_; }

    Vec3f projected(const Texture& texture, const Interaction& at, double footprint) const
    {
        const double width = footprint / s_.scale;
        if (s_.uv) return texture.lookup(at.uv, width);
        const Vec3d w = triplanar_lookup_weights(at.geometric_normal, s_.exponent);
        Vec3f sum(0.0f);
        for (int axis = 0; axis < 3; ++axis) {
            const double share = w[static_cast<unsigned>(axis)];
            if (share > 0.0) sum += texture.lookup(triplanar_coordinates(at.texture_point, axis) / s_.scale, width) * static_cast<float>(share);
        }
        return sum;
    }

    /// A normal map stores (n + 1) / 2, green upwards; the slopes of its height are -n_x / n_z, -n_y / n_z.
    Vec3d projected_slopes(const Interaction& at, double footprint) const
    {
        const Vec3d w = triplanar_lookup_weights(at.geometric_normal, s_.exponent);
        Vec3d gradient(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const double share = w[static_cast<unsigned>(axis)];
            if (share == 0.0) continue;
            const Vec3d n =
                Vec3d(s_.normal_map->lookup(triplanar_coordinates(at.texture_point, axis) / s_.scale, footprint / s_.scale)) * 2.0 - Vec3d(1.0);
            const double up = std::max(n.z, 0.1);
            gradient += triplanar_gradient({-n.x / up, -n.y / up}, axis) * share;
        }
        return gradient;
    }

    Settings s_;
    Vec3f mean_{0.5f};
    Vec3f tint_{1.0f};
};

void MaterialLook::match_mean()
{
    mean_ = s_.palette[0];
    if (s_.procedure == Procedure::plain) return;
    constexpr int places = 1024;
    Vec3d sum(0.0);
    for (int i = 0; i < places; ++i) {
        Interaction at;
        const auto random = [&](int k) { return unit_real(hash_cell(s_.seed, i, k)); };
        at.texture_point = Vec3d(random(0), random(1), random(2)) * 1000.0;
        const double z = random(3), angle = 2.0 * 3.141592653589793 * random(4), r = std::sqrt(1.0 - z * z);
        at.geometric_normal = at.shading_normal = Vec3d(r * std::cos(angle), r * std::sin(angle), z);
        sum += Vec3d(evaluate_procedure(s_.procedure, s_.palette, s_.seed, at, 0.0).albedo);
    }
    mean_ = Vec3f(sum / places);
    if (s_.mean) tint_ = *s_.mean / mean_;
}

Settings procedural_settings(const std::string& name, Procedure procedure, const ColorConverter& to_rendering)
{
    Settings s;
    s.procedure = procedure;
    s.seed = hash_name(0, name);
    const Palette& source = procedure_palette(procedure);
    for (std::size_t i = 0; i < source.size(); ++i) s.palette[i] = inside_unit_cube(converted(to_rendering, {Vec3d(source[i]), "lin_rec709"}));
    s.roughness = kRoughness[static_cast<std::size_t>(procedure)];
    s.variation = procedure == Procedure::plain || procedure == Procedure::water ? 0.0 : 0.08;
    s.coat = procedure == Procedure::water ? 1.0f : 0.0f;
    s.tint = s.variation > 0.0 ? 0.25 : 0.0;
    return s;
}

std::unique_ptr<Texture> open_texture(const Values& values, const std::string& key, TextureEncoding encoding, std::uint64_t seed,
                                      const PathResolver& resolve)
{
    if (!values.has(key)) return nullptr;
    const std::string path = resolve ? resolve(values.text(key), values.where(key)) : values.text(key);
    return std::make_unique<Texture>(path, TextureOptions{.encoding = encoding, .stochastic = values.boolean("stochastic"), .seed = seed},
                                     values.where(key));
}

void add_textures(Settings& s, const Values& values, const ColorConverter& to_rendering, const PathResolver& resolve)
{
    s.scale = values.number("scale");
    s.exponent = values.number("triplanar_exponent");
    s.uv = values.text("projection") == "uv";
    const std::string& space = values.text("colorspace");
    s.albedo = open_texture(values, "albedo_texture", space == "srgb" ? TextureEncoding::srgb : TextureEncoding::linear, s.seed, resolve);
    s.albedo_matrix = matrix_from(to_rendering, space == "srgb" ? "lin_rec709" : space);
    s.roughness_map = open_texture(values, "roughness_texture", TextureEncoding::linear, s.seed, resolve);
    s.normal_map = open_texture(values, "normal_texture", TextureEncoding::linear, s.seed, resolve);
    if (s.normal_map && s.uv)
        throw values.problem("normal_texture", "a normal map needs a triplanar projection", "projection = \"triplanar\"", "\"uv\"");
}

}  // namespace

const Schema& material_schema()
{
    static const Schema schema{
        "material",
        "How a material looks. With an empty table, or none, the procedural look of its name (sand, bedrock, rock, soil, water), so that no file is "
        "needed.",
        {
            {.name = "procedural",
             .type = ParameterType::choice,
             .doc = "Procedural look; default: that of the material's name, or plain if an albedo or an image is given or the name has none",
             .choices = procedure_names()},
            {.name = "albedo",
             .type = ParameterType::color,
             .doc = "Colour of a plain material; of a procedural one, the mean it is scaled to",
             .minimum = 0.0,
             .maximum = 1.0},
            {.name = "albedo_texture", .type = ParameterType::path, .doc = "Image of the albedo (EXR, TIFF, PNG, JPEG, HDR)"},
            {.name = "colorspace",
             .type = ParameterType::choice,
             .doc = "Colour space of albedo_texture",
             .fallback = std::string("srgb"),
             .choices = kTextureSpaces},
            {.name = "ior",
             .type = ParameterType::number,
             .doc = "Refractive index: light passes the surface, and the material fills a body. Default: 1.333 for water, unless it is given an "
                    "albedo or a "
                    "coat; else light does not pass",
             .minimum = 1.0,
             .maximum = 3.0},
            {.name = "medium",
             .type = ParameterType::text,
             .doc = "What fills the body: clear, coastal or deep (water), or a [medium.NAME]. Default: clear for water, else nothing"},
            {.name = "roughness",
             .type = ParameterType::number,
             .doc =
                 "Standard deviation of unseen slopes: of the rough diffuse model, where 0 is Lambert; of a surface that light passes, where 0 is a "
                 "mirror. Default: 0 for plain and water, 0.3 to 0.4 else",
             .minimum = 0.0,
             .maximum = 1.0},
            {.name = "coat",
             .type = ParameterType::number,
             .doc = "Share of the surface under a smooth film of water that mirrors. Default: 1 for water with an albedo, 0 else",
             .minimum = 0.0,
             .maximum = 1.0},
            {.name = "roughness_texture", .type = ParameterType::path, .doc = "Image of the roughness, its first channel, numbers as they are"},
            {.name = "normal_texture",
             .type = ParameterType::path,
             .doc = "Tangent-space normal map, (n + 1) / 2, green upwards, numbers as they are"},
            {.name = "scale",
             .type = ParameterType::length,
             .doc = "Size of one repeat of the images",
             .fallback = 4.0,
             .unit = "m",
             .minimum = 0.0,
             .above_minimum = true},
            {.name = "projection",
             .type = ParameterType::choice,
             .doc = "How images are laid onto the surface",
             .fallback = std::string("triplanar"),
             .choices = {"triplanar", "uv"}},
            {.name = "triplanar_exponent",
             .type = ParameterType::number,
             .doc = "Sharpness of the change between the three projections",
             .fallback = 8.0,
             .minimum = 1.0,
             .maximum = 64.0},
            {.name = "stochastic",
             .type = ParameterType::boolean,
             .doc = "Hide the repetition of images by hashed, blended hexagonal tiles",
             .fallback = true},
            {.name = "variation",
             .type = ParameterType::number,
             .doc = "Relative change of the albedo on scales of 10 to 100 m. Default: 0 for plain, 0.08 for procedural looks, 0.12 for images",
             .minimum = 0.0,
             .maximum = 1.0},
            {.name = "tint",
             .type = ParameterType::number,
             .doc = "Relative change of the albedo from one instance to the next (rocks). Default: 0 for plain, 0.25 else",
             .minimum = 0.0,
             .maximum = 1.0},
            {.name = "contrast",
             .type = ParameterType::number,
             .doc = "Of a procedural look's colours about their mean",
             .fallback = 1.0,
             .minimum = 0.0,
             .maximum = 2.0},
            {.name = "bump",
             .type = ParameterType::number,
             .doc = "Factor of the relief of a procedural look or a normal map",
             .fallback = 1.0,
             .minimum = 0.0,
             .maximum = 4.0},
            {.name = "mask",
             .type = ParameterType::tables,
             .doc = "Where another material shows instead; masks with one `into` are multiplied",
             .max_count = 32,
             .discriminator = "by",
             .items = mask_schemas()},
        }};
    return schema;
}

std::unique_ptr<Look> make_look(const std::string& name, const Values& values, const ColorConverter& to_rendering, const PathResolver& resolve)
{
    const bool own_color = values.has("albedo") || values.has("albedo_texture");
    const bool water = procedure_for(name) == Procedure::water && !values.has("albedo_texture");  // a colour does not still its waves
    const Procedure procedure = values.has("procedural") ? procedure_for(values.text("procedural"))
                                : own_color && !water    ? Procedure::plain
                                                         : procedure_for(name);
    Settings s = procedural_settings(name, procedure, to_rendering);
    add_textures(s, values, to_rendering, resolve);
    if (s.albedo) s.variation = 0.12, s.tint = 0.25;
    if (values.has("roughness")) s.roughness = static_cast<float>(values.number("roughness"));
    if (values.has("coat")) s.coat = static_cast<float>(values.number("coat"));
    if (values.has("tint")) s.tint = values.number("tint");
    if (values.has("variation")) s.variation = values.number("variation");
    s.contrast = values.number("contrast");
    s.bump = values.number("bump");
    if (values.has("albedo")) {
        const Vec3f asked = inside_unit_cube(converted(to_rendering, values.color("albedo")));
        if (procedure == Procedure::plain)
            s.palette[0] = asked;
        else
            s.mean = asked;
    }
    return std::make_unique<MaterialLook>(std::move(s));
}

std::unique_ptr<Look> default_look(const std::string& name, const ColorConverter& to_rendering)
{
    return std::make_unique<MaterialLook>(procedural_settings(name, procedure_for(name), to_rendering));
}

}  // namespace hoodoo
