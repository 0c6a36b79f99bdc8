// A client of MORSE in C++17, with nothing but the standard library and POSIX sockets.
//
//     g++ -std=c++17 -o client client.cpp && ./client        (port 4000, or MORSE_SOCKET_PORT)
//
// The scene has a robot `robot` with an actuator `motion` (MotionVW) and a sensor `pose` (Pose): see docs/socket.md.
// It drives until the pose says 0.5 m, then stops.

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <string>

// A connection that carries lines.
class Lines {
   public:
    explicit Lines(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        if (::connect(socket_, reinterpret_cast<sockaddr *>(&address), sizeof address) != 0)
            throw std::runtime_error("no simulation on port " + std::to_string(port));
    }
    Lines(const Lines &) = delete;
    Lines &operator=(const Lines &) = delete;
    ~Lines() { ::close(socket_); }

    void write(std::string line) {
        line += '\n';
        for (size_t sent = 0; sent < line.size();) {
            ssize_t count = ::send(socket_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
            if (count <= 0) throw std::runtime_error("the simulation has ended");
            sent += static_cast<size_t>(count);
        }
    }

    std::string read() {
        for (size_t end; (end = rest_.find('\n')) == std::string::npos;) {
            char buffer[4096];
            ssize_t count = ::recv(socket_, buffer, sizeof buffer, 0);
            if (count <= 0) throw std::runtime_error("the simulation has ended");
            rest_.append(buffer, static_cast<size_t>(count));
        }
        size_t end = rest_.find('\n');
        std::string line = rest_.substr(0, end);
        rest_.erase(0, end + 1);
        return line;
    }

   private:
    int socket_;
    std::string rest_;
};

// Services: a request is `id component service [arguments]`, its answer `id SUCCESS|FAILED|PREEMPTED [result]`.
class Services {
   public:
    explicit Services(int port) : lines_(port) {}

    std::string call(const std::string &component, const std::string &service, const std::string &arguments = "[]") {
        const std::string id = std::to_string(++last_);
        lines_.write(id + ' ' + component + ' ' + service + ' ' + arguments);
        for (;;) {
            std::string line = lines_.read();
            if (line.compare(0, id.size() + 1, id + ' ') != 0) continue;
            line.erase(0, id.size() + 1);
            if (line.compare(0, 7, "SUCCESS") == 0) return line.size() > 8 ? line.substr(8) : "";
            throw std::runtime_error(component + '.' + service + ": " + line);
        }
    }

   private:
    Lines lines_;
    int last_ = 0;
};

// A number of a message; use a JSON library for more than that.
double number(const std::string &json, const std::string &name) {
    size_t at = json.find('"' + name + "\":");
    if (at == std::string::npos) throw std::runtime_error("no field " + name + " in " + json);
    return std::strtod(json.c_str() + at + name.size() + 3, nullptr);
}

int main() try {
    const char *given = std::getenv("MORSE_SOCKET_PORT");
    Services simulation(given ? std::atoi(given) : 4000);
    auto port = [&](const std::string &name) {
        return std::stoi(simulation.call("simulation", "get_stream_port", "[\"" + name + "\"]"));
    };
    Lines motion(port("robot.motion")), pose(port("robot.pose"));
    std::string data = pose.read();
    const double x = number(data, "x"), y = number(data, "y");
    double driven = 0.0;
    while (driven < 0.5) {
        motion.write("{\"v\": 0.5, \"w\": 0.0}");
        data = pose.read();
        driven = std::hypot(number(data, "x") - x, number(data, "y") - y);
    }
    // on the same connection: a service may be faster than the last message of a stream
    motion.write("{\"v\": 0.0, \"w\": 0.0}");
    const std::string time = simulation.call("time", "now");
    std::cout << "driven " << driven << " m, at " << time << " s\n";
    return 0;
} catch (const std::exception &error) {
    std::cerr << error.what() << '\n';
    return 1;
}
