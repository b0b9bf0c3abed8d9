// press.cpp: loads a calibrated network, presses its top down and prints the force. The network frees itself.
//   press NETWORK.json
#include <palpate/sim.h>

#include <cstdio>
#include <memory>

int main(int argc, char **argv) {
    palp_error error = {PALP_OK, "usage: press NETWORK.json"};
    palp_network *made = nullptr;
    palp_model model;
    palp_mesh_source source;

    if (argc != 2 || palp_model_read(argv[1], &model, &source, &error) ||
        palp_network_from_model(&model, nullptr, 0, nullptr, nullptr, &made, &error)) {
        std::fprintf(stderr, "press: %s\n", error.text);
        return 1;
    }
    const std::unique_ptr<palp_network, decltype(&palp_network_free)> network(made, palp_network_free);
    for (int i = 1; i <= 10; i++) { // 1 mm in 0.1 s
        const palp_status status = palp_network_step(network.get(), 1e-4 * i, 0.01, nullptr);
        if (status) {
            std::fprintf(stderr, "press: %s\n", palp_status_text(status));
            return 1;
        }
        std::printf("%.1f mm  %.4f N\n", 0.1 * i, palp_network_force(network.get()));
    }
}
