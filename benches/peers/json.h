// As much of JSON as reading a scene needs: one value type, no escapes beyond
// those that names in scenes have.
#pragma once

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace json {

struct Value {
    enum class Kind { Null, Bool, Number, Text, List, Object } kind = Kind::Null;
    double number = 0; // of a Bool, too: 0 or 1
    std::string text;
    std::vector<Value> list;
    std::map<std::string, Value> fields;

    bool null() const { return kind == Kind::Null; }
    const Value &operator[](const std::string &name) const {
        const auto found = fields.find(name);
        if (found == fields.end()) {
            throw std::runtime_error("the scene has no field `" + name + "`");
        }
        return found->second;
    }
    double at(std::size_t i) const { return list.at(i).number; }
};

class Parser {
  public:
    explicit Parser(const std::string &text) : next_(text.c_str()) {}

    Value value() {
        skip();
        Value v;
        switch (*next_) {
        case '{':
            v.kind = Value::Kind::Object;
            ++next_;
            while (!closes('}')) {
                const std::string name = value().text;
                expect(':');
                v.fields[name] = value();
            }
            return v;
        case '[':
            v.kind = Value::Kind::List;
            ++next_;
            while (!closes(']')) {
                v.list.push_back(value());
            }
            return v;
        case '"':
            v.kind = Value::Kind::Text;
            for (++next_; *next_ && *next_ != '"'; ++next_) {
                if (*next_ == '\\') {
                    ++next_;
                }
                v.text += *next_;
            }
            expect('"');
            return v;
        case 't':
        case 'f':
            v.kind = Value::Kind::Bool;
            v.number = *next_ == 't';
            next_ += v.number != 0 ? 4 : 5;
            return v;
        case 'n':
            next_ += 4;
            return v;
        default:
            char *end = nullptr;
            v.kind = Value::Kind::Number;
            v.number = std::strtod(next_, &end);
            if (end == next_) {
                throw std::runtime_error("the scene is no JSON near: " +
                                         std::string(next_).substr(0, 20));
            }
            next_ = end;
            return v;
        }
    }

  private:
    void skip() {
        while (*next_ == ' ' || *next_ == '\n' || *next_ == '\t' || *next_ == '\r') {
            ++next_;
        }
    }
    void expect(char c) {
        skip();
        if (*next_ != c) {
            throw std::runtime_error(std::string("the scene is no JSON: expected ") + c);
        }
        ++next_;
    }
    // Also takes the comma before the next element.
    bool closes(char c) {
        skip();
        if (*next_ == ',') {
            ++next_;
            return false;
        }
        if (*next_ == '\0') {
            throw std::runtime_error("the scene ends too early");
        }
        if (*next_ != c) {
            return false;
        }
        ++next_;
        return true;
    }

    const char *next_;
};

inline Value read(const char *path) {
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error(std::string("cannot read ") + path);
    }
    std::stringstream text;
    text << file.rdbuf();
    const std::string content = text.str();
    return Parser(content).value();
}

} // namespace json
