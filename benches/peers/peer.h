// What the peers written in C++ share: arguments, the table, samples, the result.
#pragma once

#include "json.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace peer {

constexpr double SAMPLE = 0.08; // s, between heights

struct Pose {
    double position[3]; // m
    double turn[4];     // unit quaternion, its scalar last
};

// SCENE.json RESULT.json RATE_HZ ITERATIONS SECONDS LIMIT_S
struct Job {
    explicit Job(char **argv)
        : scene(json::read(argv[0])), result(argv[1]), rate(std::atof(argv[2])),
          iterations(std::atoi(argv[3])), seconds(std::atof(argv[4])), limit(std::atof(argv[5])) {}

    json::Value scene;
    std::string result;
    double rate;
    int iterations;
    double seconds, limit;
};

struct Law {
    double amplitude = 0, frequency = 0, duration = 0, rest = 0, total = 0;
    double x(double time) const {
        if (time < 0 || time >= total) {
            return 0;
        }
        const double t = std::fmod(time, duration + rest);
        return t < duration ? amplitude * std::sin(2 * M_PI * frequency * t) : 0;
    }
};

inline Law law(const json::Value &motion) {
    Law l;
    if (!motion.null()) {
        l.amplitude = motion["amplitude_m"].number;
        l.frequency = motion["frequency_hz"].number;
        l.duration = motion["duration_s"].number;
        l.rest = motion["rest_s"].number;
        l.total = motion["periods"].number * (l.duration + l.rest) - l.rest;
    }
    return l;
}

inline double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// JSON has no other numbers.
inline void number(std::ostream &out, double value) {
    if (std::isfinite(value)) {
        out << value;
    } else {
        out << "null";
    }
}

// Carries a scene on in `lab` and writes the result. A laboratory has `drive(x, step)`, which
// sends the table to x at the end of the step, `step(length)`, and `poses()` of the grains.
template <class Laboratory>
void carry(const Job &job, const std::string &version, Laboratory &lab) {
    const Law table = law(job.scene["table"]["motion"]);
    std::ostringstream series;
    series.precision(10);
    const auto sample = [&](double time) {
        series << (series.tellp() > 0 ? "," : "") << "{\"time_s\":" << time << ",\"z_m\":[";
        bool first = true;
        for (const Pose &pose : lab.poses()) {
            series << (first ? "" : ",");
            number(series, pose.position[2]);
            first = false;
        }
        series << "]}";
    };
    sample(0);
    const double dt = 1 / job.rate;
    const long last = std::lround(job.seconds * job.rate);
    double wall = 0, next = SAMPLE, x = job.scene["table"]["x_m"].number;
    long step = 0;
    while (step < last && wall < job.limit) {
        const auto start = std::chrono::steady_clock::now();
        ++step;
        if (table.total > 0) {
            x = table.x(step * dt);
            lab.drive(x, dt);
        }
        lab.step(dt);
        wall += seconds_since(start);
        if (step * dt >= next - dt / 2 || step == last) {
            next += SAMPLE;
            sample(step * dt);
        }
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::ofstream out(job.result);
    out.precision(17);
    out << "{\"version\":\"" << version << "\",\"steps\":" << step
        << ",\"simulated_s\":" << step * dt << ",\"wall_s\":" << wall
        << ",\"peak_memory_mib\":" << static_cast<double>(usage.ru_maxrss) / 1024
        << ",\"table_x_m\":" << x << ",\"poses\":[";
    bool first = true;
    for (const Pose &pose : lab.poses()) {
        out << (first ? "[" : ",[");
        for (const double p : pose.position) {
            number(out, p);
            out << ',';
        }
        for (int i = 0; i < 4; ++i) {
            out << (i > 0 ? "," : "");
            number(out, pose.turn[i]);
        }
        out << ']';
        first = false;
    }
    out << "],\"series\":[" << series.str() << "]}\n";
    if (!out.flush()) {
        throw std::runtime_error("cannot write " + job.result);
    }
}

// The main function: `run` gets the arguments, of which there must be `count`.
template <class Run> int main(int argc, char **argv, int count, const char *usage, const Run &run) {
    if (argc != count + 1) {
        std::cerr << "usage: " << usage << '\n';
        return 2;
    }
    try {
        run(argv + 1);
    } catch (const std::exception &error) {
        std::cerr << "error: " << error.what() << '\n';
        return 1;
    }
    return 0;
}

} // namespace peer
