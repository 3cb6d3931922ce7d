// Parameters of landform nodes: heights and lengths in metres, weights from falloffs that all bounded kinds share.
#include "terrain/surfaces/landform_schemas.h"

#include "terrain/surfaces/noise_parameters.h"
#include "terrain/surfaces/path_tables.h"

namespace hoodoo
{

namespace
{

Parameter length(const std::string& name, const std::string& doc)
{
    return {.name = name, .type = ParameterType::length, .doc = doc, .required = true, .unit = "m", .minimum = 0, .above_minimum = true};
}

Parameter optional_length(const std::string& name, const std::string& doc)
{
    Parameter p = length(name, doc);
    p.required = false;
    return p;
}

Parameter height(const std::string& doc)
{
    return {.name = "height", .type = ParameterType::length, .doc = doc, .fallback = 0.0, .unit = "m"};
}

Parameter of(const std::string& doc, int least)
{
    return {.name = "of", .type = ParameterType::names, .doc = doc, .required = true, .min_count = least, .max_count = 65536};
}

Parameter of_one()
{
    return {.name = "of", .type = ParameterType::text, .doc = "The node.", .required = true};
}

Parameter plain_number(const std::string& name, double fallback, double least, double most, const std::string& doc)
{
    return {.name = name, .type = ParameterType::number, .doc = doc, .fallback = fallback, .minimum = least, .maximum = most};
}

std::vector<Parameter> falloff(bool required)
{
    Parameter radius = length("radius", "How far its weight reaches.");
    radius.required = required;
    return {
        std::move(radius),
        {.name = "core", .type = ParameterType::length, .doc = "Up to here its weight is 1.", .fallback = 0.0, .unit = "m", .minimum = 0},
        {.name = "power",
         .type = ParameterType::integer,
         .doc = "Of the falloff (1 - t^2)^power: 3 is softer at the border.",
         .fallback = std::int64_t{3},
         .minimum = 2,
         .maximum = 3},
    };
}

Parameter points(const std::string& doc, int least, int most)
{
    return {.name = "points", .type = ParameterType::points, .doc = doc, .required = true, .unit = "m", .min_count = least, .max_count = most};
}

void append(Schema& schema, std::vector<Parameter> more)
{
    for (Parameter& p : more) schema.parameters.push_back(std::move(p));
}

Schema path_schema(const std::string& name, const std::string& doc, std::vector<Parameter> place)
{
    Schema schema{name, doc, std::move(place)};
    append(schema, falloff(true));
    append(schema, {
                       {.name = "profile",
                        .type = ParameterType::vector,
                        .doc = "Knots of the cross section: the distance and the height above the skeleton of each in turn; a smooth curve between.",
                        .unit = "m",
                        .min_count = 2,
                        .max_count = 512},
                       {.name = "sharp", .type = ParameterType::boolean, .doc = "The profile begins as a crest or a notch.", .fallback = false},
                       optional_length("rough", "How far noise raises and lowers it at most."),
                       optional_length("rough_wavelength", "Size of the largest of these bumps."),
                       plain_number("rough_octaves", 5.0, 1.0, 24.0, "How many sizes of them."),
                       {.name = "rough_noise",
                        .type = ParameterType::choice,
                        .doc = "Their kind.",
                        .fallback = std::string("fbm"),
                        .choices = {"fbm", "ridged", "billow"}},
                   });
    return schema;
}

Schema dictionary_schema()
{
    const auto area = [](const std::string& name, const std::string& doc) {
        return Parameter{.name = name, .type = ParameterType::vector, .doc = doc, .unit = "m", .min_count = 4, .max_count = 4};
    };
    return {"dictionary",
            "A coarse terrain written as a sparse sum of patches of a fine one, whose detail it takes on (Guerin2016).",
            {{.name = "terrain", .type = ParameterType::text, .doc = "The coarse terrain: any height.", .required = true},
             {.name = "exemplar", .type = ParameterType::text, .doc = "The terrain whose patches are the dictionary: any height.", .required = true},
             length("spacing", "Between patches; forms much larger come from the coarse terrain, smaller ones from the exemplar."),
             optional_length("detail", "Between samples of the exemplar; a 32nd of the spacing by default."),
             {.name = "atoms",
              .type = ParameterType::integer,
              .doc = "How many patches the dictionary has at most, each in one of eight orientations.",
              .fallback = std::int64_t{64},
              .minimum = 1,
              .maximum = 4096},
             {.name = "terms",
              .type = ParameterType::integer,
              .doc = "How many of them one patch may use.",
              .fallback = std::int64_t{2},
              .minimum = 1,
              .maximum = 8},
             area("area", "Where patches lie: x and y from, x and y to. The coarse terrain's extent by default; needed if that has no end."),
             area("exemplar_area", "Where they are cut: the exemplar's extent by default; needed if that has no end.")}};
}

std::vector<Schema> primitive_schemas()
{
    Parameter at{
        .name = "at", .type = ParameterType::vector, .doc = "Its place and height.", .required = true, .unit = "m", .min_count = 3, .max_count = 3};
    Schema noise{"noise", "A sum of noise, everywhere or within a circle.", noise_parameters("noise", 8.0)};
    append(noise, {height("Mean height."),
                   {.name = "at", .type = ParameterType::vector, .doc = "Middle of the circle.", .unit = "m", .min_count = 2, .max_count = 2}});
    append(noise, falloff(false));
    return {
        {"flat", "One height everywhere.", {height("That height.")}},
        std::move(noise),
        {"terrain",
         "Another terrain of the scene, as the ground. It is not rendered itself.",
         {{.name = "terrain", .type = ParameterType::text, .doc = "Its name.", .required = true}}},
        path_schema("point", "A hill or a pit about a point.", {at}),
        path_schema("segment", "A ridge or a ditch along a straight line.", {points("Two ends.", 2, 2)}),
        path_schema("curve", "A ridge, a river or a road along a curve.",
                    {points("The curve.", 1, 65536), smooth_parameter(),
                     optional_length("joint", "How far from a corner heights on its two sides run together; a quarter of the radius by default.")}),
        dictionary_schema(),
    };
}

std::vector<Schema> operator_schemas()
{
    return {
        {"blend",
         "All of them, by their weights.",
         {of("The nodes.", 1),
          {.name = "weight",
           .type = ParameterType::choice,
           .doc = "Its own weight: the sum of theirs, or 1 - (1 - a)(1 - b)..., which stays within 1.",
           .fallback = std::string("sum"),
           .choices = {"sum", "united"}}}},
        {"replace", "The first, and the others in its place where they weigh.", {of("What is replaced, then what replaces it.", 2)}},
        {"inset", "The same within the first only, with a softer border.", {of("What is replaced, then what replaces it.", 2)}},
        {"add", "The first, raised by the others.", {of("The ground, then what is added.", 2)}},
        {"max", "The first where nothing else is higher.", {of("The ground, then what rises out of it.", 2)}},
        {"min", "The first where nothing else is lower.", {of("The ground, then what is carved into it.", 2)}},
        {"warp",
         "A node seen through a crooked map.",
         {of_one(), length("amplitude", "How far places are moved at most, each way."), length("wavelength", "Size of the largest bends."),
          plain_number("octaves", 3.0, 1.0, 24.0, "How many sizes of bends.")}},
        {"move",
         "A node elsewhere: scaled about the origin, turned, moved.",
         {of_one(),
          {.name = "scale", .type = ParameterType::number, .doc = "Of lengths and heights.", .fallback = 1.0, .minimum = 0, .above_minimum = true},
          {.name = "turn", .type = ParameterType::angle, .doc = "Counter-clockwise, seen from above.", .fallback = 0.0, .unit = "rad"},
          {.name = "shift",
           .type = ParameterType::vector,
           .doc = "Then moved by this.",
           .fallback = std::vector<double>{0, 0, 0},
           .unit = "m",
           .min_count = 3,
           .max_count = 3}}},
    };
}

}  // namespace

std::vector<Schema> landform_node_schemas()
{
    std::vector<Schema> list = primitive_schemas();
    for (Schema& schema : operator_schemas()) list.push_back(std::move(schema));
    for (Schema& schema : list)
        schema.parameters.insert(schema.parameters.begin(),
                                 {.name = "name", .type = ParameterType::text, .doc = "What other nodes call it.", .required = true});
    return list;
}

}  // namespace hoodoo
