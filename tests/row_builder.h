// A row of the catalogue built from TOML as a scene writes it, or what it says of why not.
#pragma once

#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"

#include <memory>
#include <string>

namespace hoodoo::testing
{

/// The error's text without its excerpt, or "". `built` gets the shape; `base` is what every name of another terrain means.
inline std::string error_of_row(const std::string& name, const std::string& text, std::unique_ptr<Shape>* built = nullptr,
                                std::shared_ptr<const Surface> base = nullptr)
{
    const CatalogueEntry* row = find_in_catalogue(name);
    SceneBudget budget;
    std::vector<Problem> problems;
    const Values values = check(row->schema, parse_toml(text, "t", budget, problems), problems);
    try {
        if (!problems.empty()) throw Error(ErrorKind::scene, problems);
        BuildContext context;
        context.seed = 3;
        if (base) context.base = [&](const std::string&, const Source&) { return base; };
        Shape shape = row->make(values, context);
        if (built) *built = std::make_unique<Shape>(std::move(shape));
    } catch (const Error& error) {
        const std::string what = error.what();
        return what.substr(0, what.find('\n'));
    }
    return {};
}

}  // namespace hoodoo::testing
