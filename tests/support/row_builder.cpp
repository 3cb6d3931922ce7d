// As a scene does it: text to table, table to checked values, values to a shape.
#include "tests/support/row_builder.h"

#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "terrain/error.h"

namespace hoodoo::testing
{

std::string error_of_row(const std::string& name, const std::string& text, std::unique_ptr<Shape>* built, std::shared_ptr<const Surface> base)
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
        std::unique_ptr<Shape> shape(new Shape(row->make(values, context)));  // in place: a move makes GCC 12 warn of a variant it cannot follow
        if (built) *built = std::move(shape);
    } catch (const Error& error) {
        const std::string what = error.what();
        return what.substr(0, what.find('\n'));
    }
    return {};
}

}  // namespace hoodoo::testing
