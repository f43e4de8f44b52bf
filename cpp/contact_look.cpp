#include "contact_look.h"

#include <algorithm>
#include <iterator>

namespace pluvia {

void SubstepRecord::append(const SubstepRecord &other) {
    const double first = static_cast<double>(bodies.size() / BODY);
    bodies.insert(bodies.end(), other.bodies.begin(), other.bodies.end());
    for (std::size_t i = 0; i < other.contacts.size(); ++i) {
        const bool body = i % CONTACT < 2;
        contacts.push_back(other.contacts[i] + (body ? first : 0));
    }
}

void SubstepRecord::read(rust::Vec<double> &bodies_out, rust::Vec<double> &contacts_out) const {
    bodies_out.clear();
    contacts_out.clear();
    std::copy(bodies.begin(), bodies.end(), std::back_inserter(bodies_out));
    std::copy(contacts.begin(), contacts.end(), std::back_inserter(contacts_out));
}

} // namespace pluvia
