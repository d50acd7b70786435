// SPDX-License-Identifier: GPL-3.0-or-later
/// JSON values for output.

#pragma once

#include <concepts>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace hilda::io {

/// A JSON value that is built in memory and then written. The members of an object keep the order of their
/// insertion.
///
/// The syntax is that of nlohmann::ordered_json, which writes the text. Its header is not included here: it
/// would take seconds of compile time in each file that builds a value.
class Json {
public:
    Json();  ///< null
    Json(std::nullptr_t) : Json() {}
    Json(const char* text);
    Json(const std::string& text);
    /// A number. One that is not finite is written as null.
    Json(double number);
    Json(std::same_as<bool> auto truth) : Json(Truth{truth}) {}
    Json(std::signed_integral auto number) : Json(Integer{number}) {}
    Json(std::unsigned_integral auto number) requires(!std::same_as<decltype(number), bool>)
        : Json(Natural{number})
    {}
    /// An array
    template <class Element>
    Json(const std::vector<Element>& elements) : Json(array())
    {
        for (const Element& element : elements) push_back(element);
    }
    /// An object if each element is a pair {"key", value}, otherwise an array
    Json(std::initializer_list<Json> elements);

    static Json array();   ///< []
    static Json object();  ///< {}

    Json(const Json& other);
    Json(Json&& other) noexcept;
    Json& operator=(Json other) noexcept;
    ~Json();

    /// The member of an object; it is added if there is none. Null becomes an object. std::logic_error for
    /// other values.
    Json& operator[](const std::string& key);
    /// Appends to an array. Null becomes an array. std::logic_error for other values.
    void push_back(Json element);
    /// Adds the members of an object to this one and replaces those with the same key
    void update(const Json& members);
    const Json& at(size_t element) const;  ///< element of an array; std::out_of_range
    size_t size() const;                   ///< number of elements or members; 0 for other values

    /// The text, indented by two spaces, with a line break at the end. Bytes that are not UTF-8 are replaced
    /// by U+FFFD.
    std::string text() const;

private:
    struct Truth {
        bool is;
    };
    struct Integer {
        long long is;
    };
    struct Natural {
        unsigned long long is;
    };
    explicit Json(Truth truth);
    explicit Json(Integer number);
    explicit Json(Natural number);

    struct Value;
    std::unique_ptr<Value> value;  ///< empty: null
};

/// Version of nlohmann-json, which writes the text
std::string json_library_version();

}  // namespace hilda::io
