// Compares a number with what it should be, and reports each comparison.
#include "checks.h"

#include <cmath>
#include <sstream>

namespace referee {

void Checks::equal(const std::string &what, double got, double expected, double tolerance) {
    std::ostringstream text;
    text << expected << " ± " << tolerance;
    judge(what, std::abs(got - expected) <= tolerance, got, text.str());
}

void Checks::below(const std::string &what, double got, double limit) {
    std::ostringstream text;
    text << "at most " << limit;
    judge(what, got <= limit, got, text.str());
}

void Checks::above(const std::string &what, double got, double limit) {
    std::ostringstream text;
    text << "at least " << limit;
    judge(what, got >= limit, got, text.str());
}

void Checks::judge(const std::string &what, bool holds, double got, const std::string &expected) {
    ++made_;
    failed_ += holds ? 0 : 1;
    if (!holds) {
        out_ << "FAILS  " << what << ": expected " << expected << ", got " << got << '\n';
    }
}

} // namespace referee
