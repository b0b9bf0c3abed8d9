/* network_parts.c: numbers of a network that is in parts. */
#include "network_internal.h"

double network_sum_of_parts(const palp_network *net, double value) {
    if (net->ranks)
        net->ranks->sum(net->ranks, 1, &value);
    return value;
}

double network_largest_of_parts(const palp_network *net, double value) {
    return net->ranks ? net->ranks->largest(net->ranks, value) : value;
}
