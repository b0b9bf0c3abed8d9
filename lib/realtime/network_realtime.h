/* network_realtime.h: what palp_network_step_within keeps beside a network. Internal. */
#ifndef NETWORK_REALTIME_H
#define NETWORK_REALTIME_H

#include <palpate/network.h>

typedef struct network_realtime network_realtime;

void network_realtime_free(network_realtime *realtime); /* NULL is fine */

/* As after enable, for the state that the network was set to: a part of palp_network_reset. */
void network_realtime_reset(palp_network *net);

#endif
