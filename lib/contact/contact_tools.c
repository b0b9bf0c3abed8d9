/* contact_tools.c: making a network ready for tools, placing them, and what they feel. */
#include "contact_internal.h"

palp_contact_settings palp_contact_settings_default(void) {
    return (palp_contact_settings){.stiffness = 20.0, .grasp_stiffness = 100.0, .smoothing = 0.01};
}

static bool positive(double v) {
    return v > 0.0 && isfinite(v);
}

palp_status palp_network_enable_tools(palp_network *net, size_t max_tools, size_t max_grasped,
                                      const palp_contact_settings *settings) {
    const palp_contact_settings *s = settings;
    if (!net || !s || contact_of(net) || max_tools > INT32_MAX || max_grasped > net->n_nodes)
        return PALP_ERR_ARGUMENT;
    bool weighs = dot3(s->gravity_m_s2, s->gravity_m_s2) > 0.0;
    if (!positive(s->stiffness) || !positive(s->grasp_stiffness) || !positive(s->smoothing) ||
        !finite3(s->gravity_m_s2) || (weighs && !net->mass))
        return PALP_ERR_ARGUMENT;
    if (max_tools > 0 && net->n_surface == 0)
        return PALP_ERR_UNSUPPORTED;
    network_term *terms[3];
    size_t n = 0;
    if (weighs)
        terms[n++] = network_gravity_new(s->gravity_m_s2);
    terms[n++] = grasp_new(max_grasped, s->grasp_stiffness);
    terms[n++] = contact_term_new(net, max_tools, s);
    palp_status status = network_add_terms(net, n, terms);
    if (!status)
        palp_network_reset(net);
    return status;
}

palp_status palp_network_set_tools(palp_network *net, size_t n, const palp_tool *tools) {
    if (!net || (n > 0 && !tools))
        return PALP_ERR_ARGUMENT;
    contact_set *set = contact_of(net);
    return set ? contact_set_tools(set, n, tools) : PALP_ERR_ARGUMENT;
}

palp_status palp_network_tool_force(const palp_network *net, palp_tool_force *force) {
    if (!net || !force)
        return PALP_ERR_ARGUMENT;
    const contact_set *set = contact_of(net);
    if (!set || !force)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < set->n_tools; i++)
        force[i] = i < set->now.n_tools ? set->now.felt[i] : (palp_tool_force){.contacts = 0};
    return PALP_OK;
}
