// Arithmetic in scenes, by muParser: it compiles an expression to a flat program, without loops, strings, assignments to constants or side effects.
// The only includer of muParser. Angles are radians; log is the natural logarithm. Our own list of functions, so that none depends on muParser's
// version.
#include "renderer/scene/expression.h"

#include <muParser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace hoodoo
{
namespace
{

constexpr double kPi = 3.14159265358979323846;

struct Function1 {
    const char* name;
    double (*call)(double);
};
struct Function2 {
    const char* name;
    double (*call)(double, double);
};
struct Function3 {
    const char* name;
    double (*call)(double, double, double);
};

constexpr std::array functions1 = {
    Function1{"sin", [](double x) { return std::sin(x); }},         Function1{"cos", [](double x) { return std::cos(x); }},
    Function1{"tan", [](double x) { return std::tan(x); }},         Function1{"asin", [](double x) { return std::asin(x); }},
    Function1{"acos", [](double x) { return std::acos(x); }},       Function1{"atan", [](double x) { return std::atan(x); }},
    Function1{"exp", [](double x) { return std::exp(x); }},         Function1{"log", [](double x) { return std::log(x); }},
    Function1{"log10", [](double x) { return std::log10(x); }},     Function1{"log2", [](double x) { return std::log2(x); }},
    Function1{"sqrt", [](double x) { return std::sqrt(x); }},       Function1{"abs", [](double x) { return std::abs(x); }},
    Function1{"floor", [](double x) { return std::floor(x); }},     Function1{"ceil", [](double x) { return std::ceil(x); }},
    Function1{"round", [](double x) { return std::round(x); }},     Function1{"radians", [](double x) { return x / 180.0 * kPi; }},
    Function1{"degrees", [](double x) { return x / kPi * 180.0; }},
};
constexpr std::array functions2 = {
    Function2{"atan2", [](double y, double x) { return std::atan2(y, x); }},
    Function2{"min", [](double a, double b) { return std::fmin(a, b); }},
    Function2{"max", [](double a, double b) { return std::fmax(a, b); }},
};
constexpr std::array functions3 = {
    Function3{"clamp", [](double x, double low, double high) { return std::fmax(low, std::fmin(high, x)); }},
    Function3{"mix", [](double a, double b, double w) { return a * (1.0 - w) + b * w; }},
};

std::string words(mu::EErrorCodes code)
{
    switch (code) {
        case mu::ecUNASSIGNABLE_TOKEN:
            return "unknown name in the expression";
        case mu::ecUNEXPECTED_EOF:
        case mu::ecEMPTY_EXPRESSION:
            return "the expression ends too early";
        case mu::ecMISSING_PARENS:
        case mu::ecUNEXPECTED_PARENS:
            return "parentheses do not match in the expression";
        case mu::ecTOO_FEW_PARAMS:
        case mu::ecTOO_MANY_PARAMS:
            return "wrong number of arguments in the expression";
        case mu::ecUNEXPECTED_STR:
        case mu::ecUNTERMINATED_STRING:
        case mu::ecSTRING_EXPECTED:
            return "the expression holds a text";
        default:
            return "the expression cannot be read";
    }
}

}  // namespace

struct Expressions::Parser {
    mu::Parser parser;
};

Expressions::Expressions() : parser_(std::make_unique<Parser>())
{
    mu::Parser& p = parser_->parser;
    p.ClearFun();
    p.ClearConst();
    p.ClearInfixOprt();
    p.DefineInfixOprt("-", [](double x) { return -x; });
    p.DefineInfixOprt("+", [](double x) { return x; });
    for (const auto& f : functions1) p.DefineFun(f.name, f.call);
    for (const auto& f : functions2) p.DefineFun(f.name, f.call);
    for (const auto& f : functions3) p.DefineFun(f.name, f.call);
    p.DefineConst("pi", kPi);
}

Expressions::~Expressions() = default;

bool Expressions::valid_name(const std::string& name)
{
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto is = [&](const auto& f) { return name == f.name; };
    if (name.empty() || name.size() > 64 || !letter(name[0]) || name == "pi") return false;
    if (!std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || digit(c); })) return false;
    return std::none_of(functions1.begin(), functions1.end(), is) && std::none_of(functions2.begin(), functions2.end(), is) &&
           std::none_of(functions3.begin(), functions3.end(), is);
}

void Expressions::define(const std::string& name, double value)
{
    parser_->parser.DefineConst(name, value);
}

Expressions::Result Expressions::evaluate(const std::string& text) const
{
    if (text.size() > max_length) return {0.0, "the expression is too long", max_length, {}};
    // muParser reads bytes and classifies them by the C locale: only printable ASCII is defined behaviour everywhere. '"' would start a text.
    const auto odd =
        std::find_if(text.begin(), text.end(), [](char c) { return (c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7f || c == '"'; });
    if (odd != text.end()) return {0.0, "the expression cannot be read", static_cast<std::size_t>(odd - text.begin()), {}};
    try {
        mu::Parser& p = parser_->parser;
        p.SetExpr(text);
        int results = 0;
        const double* values = p.Eval(results);
        if (results != 1) return {0.0, "the expression has several values", 0, {}};
        if (!std::isfinite(values[0])) return {0.0, "the expression's value is not finite", 0, {}};
        return {values[0], {}, 0, {}};
    } catch (const mu::ParserError& error) {
        const std::size_t position = error.GetPos() < 0 ? 0 : std::min(static_cast<std::size_t>(error.GetPos()), text.size());
        const bool unknown = error.GetCode() == mu::ecUNASSIGNABLE_TOKEN;
        return {0.0, words(error.GetCode()), position, unknown ? error.GetToken() : std::string()};
    }
}

}  // namespace hoodoo
