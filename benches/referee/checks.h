// The referee's own checks: problems whose answers are known.
#pragma once

#include <ostream>
#include <string>

namespace referee {

// What was expected, what came out, and whether it is near enough.
class Checks {
  public:
    explicit Checks(std::ostream &out) : out_(out) {}
    void equal(const std::string &what, double got, double expected, double tolerance);
    void below(const std::string &what, double got, double limit);
    void above(const std::string &what, double got, double limit);
    int failed() const { return failed_; }
    int made() const { return made_; }

  private:
    std::ostream &out_;
    int made_ = 0, failed_ = 0;
    void judge(const std::string &what, bool holds, double got, const std::string &expected);
};

void check_contacts(Checks &checks); // checks_contacts.cpp: collision detection
void check_problems(Checks &checks); // checks_problems.cpp: one step
void check_stepping(Checks &checks); // checks_stepping.cpp: time stepping and impact

} // namespace referee
