// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/json.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

namespace hilda::io {

namespace {

using Elements = std::vector<Json>;
using Members = std::vector<std::pair<std::string, Json>>;

}  // namespace

struct Json::Value {
    std::variant<bool, long long, unsigned long long, double, std::string, Elements, Members> is;

    static nlohmann::ordered_json converted(const Json& json);
};

nlohmann::ordered_json Json::Value::converted(const Json& json)
{
    if (!json.value) return nullptr;
    return std::visit(
        [](const auto& is) -> nlohmann::ordered_json {
            using Is = std::decay_t<decltype(is)>;
            if constexpr (std::is_same_v<Is, Elements>) {
                auto out = nlohmann::ordered_json::array();
                for (const Json& element : is) out.push_back(converted(element));
                return out;
            } else if constexpr (std::is_same_v<Is, Members>) {
                auto out = nlohmann::ordered_json::object();
                for (const auto& [key, member] : is) out[key] = converted(member);
                return out;
            } else {
                return is;
            }
        },
        json.value->is);
}

Json::Json() = default;
Json::Json(const char* text) : Json(std::string(text)) {}
Json::Json(const std::string& text) : value(new Value{text}) {}
Json::Json(double number) : value(new Value{number}) {}
Json::Json(Truth truth) : value(new Value{truth.is}) {}
Json::Json(Integer number) : value(new Value{number.is}) {}
Json::Json(Natural number) : value(new Value{number.is}) {}

Json::Json(std::initializer_list<Json> elements)
{
    const auto is_member = [](const Json& element) {
        const auto* pair = element.value ? std::get_if<Elements>(&element.value->is) : nullptr;
        return pair != nullptr && pair->size() == 2 && pair->front().value &&
               std::holds_alternative<std::string>(pair->front().value->is);
    };
    if (!std::all_of(elements.begin(), elements.end(), is_member)) {
        value.reset(new Value{Elements(elements)});
        return;
    }
    *this = object();
    for (const Json& element : elements) {
        const Elements& pair = std::get<Elements>(element.value->is);
        (*this)[std::get<std::string>(pair[0].value->is)] = pair[1];
    }
}

Json Json::array()
{
    Json out;
    out.value.reset(new Value{Elements()});
    return out;
}

Json Json::object()
{
    Json out;
    out.value.reset(new Value{Members()});
    return out;
}

Json::Json(const Json& other) : value(other.value ? std::make_unique<Value>(*other.value) : nullptr) {}
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(Json other) noexcept
{
    value = std::move(other.value);
    return *this;
}
Json::~Json() = default;

Json& Json::operator[](const std::string& key)
{
    if (!value) *this = object();
    auto* members = std::get_if<Members>(&value->is);
    if (members == nullptr) throw std::logic_error("Json: not an object: member " + key);
    const auto found = std::find_if(members->begin(), members->end(),
                                    [&key](const auto& member) { return member.first == key; });
    return found != members->end() ? found->second : members->emplace_back(key, Json()).second;
}

void Json::push_back(Json element)
{
    if (!value) *this = array();
    auto* elements = std::get_if<Elements>(&value->is);
    if (elements == nullptr) throw std::logic_error("Json: not an array");
    elements->push_back(std::move(element));
}

void Json::update(const Json& members)
{
    const auto* added = members.value ? std::get_if<Members>(&members.value->is) : nullptr;
    if (added == nullptr) throw std::logic_error("Json: not an object");
    for (const auto& [key, member] : *added) (*this)[key] = member;
}

const Json& Json::at(size_t element) const
{
    const auto* elements = value ? std::get_if<Elements>(&value->is) : nullptr;
    if (elements == nullptr) throw std::out_of_range("Json: not an array");
    return elements->at(element);
}

size_t Json::size() const
{
    if (!value) return 0;
    if (const auto* elements = std::get_if<Elements>(&value->is)) return elements->size();
    if (const auto* members = std::get_if<Members>(&value->is)) return members->size();
    return 0;
}

std::string Json::text() const
{
    return Value::converted(*this).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
           '\n';
}

std::string json_library_version()
{
    return std::to_string(NLOHMANN_JSON_VERSION_MAJOR) + '.' + std::to_string(NLOHMANN_JSON_VERSION_MINOR) +
           '.' + std::to_string(NLOHMANN_JSON_VERSION_PATCH);
}

}  // namespace hilda::io
