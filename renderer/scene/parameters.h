// [params] and what refers to them: "${name}" inserts a parameter with its type, "= expression" computes a number.
#pragma once

#include "renderer/scene/description.h"
#include "renderer/scene/expression.h"
#include "renderer/scene/toml_text.h"

#include <map>
#include <string>
#include <vector>

namespace hoodoo
{

/// Puts the values of `--set path.to.key=value` into the tree. Sections may be absent, named nodes may not.
void apply_sets(Node& root, const SceneOverrides& overrides, std::vector<Problem>& problems);

/// Takes [params] (with `-D` applied) out of the tree and replaces whatever refers to them.
class SceneParameters
{
public:
    SceneParameters(SceneBudget& budget, std::vector<Problem>& problems) : budget_(budget), problems_(problems) {}
    void apply(Node& root, const SceneOverrides& overrides);

    /// What `frame` and `t` came to be; 0 if they are no numbers.
    double number(const std::string& name) const;

private:
    void derive_time(Node& params, const Node& root);
    void define(const std::string& name, Node node);
    void substitute(Node& node, int depth);
    void compute(Node& node, const std::string& expression);
    void substitute_text(Node& node, const std::string& text, int depth);
    std::string nearest(const std::string& name) const;

    SceneBudget& budget_;
    std::vector<Problem>& problems_;
    std::map<std::string, Node> values_;
    Expressions expressions_;
};

}  // namespace hoodoo
