// Faults made on purpose, one a build (CANARY): each must be found by the
// sanitizer that looks for its kind, and `sound` must not.

#include <climits>
#include <cstdio>
#include <cstdlib>
#include <thread>

// Compilers would see through constants.
static volatile int one = 1;

[[maybe_unused]] static int sound() { return one; }

[[maybe_unused]] static int heap() {
    int *numbers = new int[4]();
    const int read = numbers[3 + one];
    delete[] numbers;
    return read;
}

[[maybe_unused]] static int stack() {
    volatile int numbers[4] = {};
    volatile int *const first = numbers;
    return first[3 + one];
}

[[maybe_unused]] static int freed() {
    int *number = new int(one);
    delete number;
    return *const_cast<volatile int *>(number);
}

[[maybe_unused]] static int leaked() {
    void *volatile lost = std::malloc(static_cast<std::size_t>(100 + one));
    lost = nullptr;
    return lost == nullptr ? 1 : 0;
}

[[maybe_unused]] static int overflow() {
    volatile int most = INT_MAX;
    return most + one > 0 ? 1 : 2;
}

[[maybe_unused]] static int shift() { return 1 << (31 + one); }

[[maybe_unused]] static int index() {
    static int numbers[4];
    return numbers[one + 3];
}

[[maybe_unused]] static int cast() {
    volatile double large = 1e300;
    return static_cast<int>(large * one);
}

[[maybe_unused]] static int race() {
    int shared = 0;
    std::thread other([&shared] { shared += one; });
    shared += one;
    other.join();
    return shared;
}

int main() { std::printf("%d\n", CANARY()); }
