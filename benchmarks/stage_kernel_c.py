"""The stage's kernel in C, for the benchmark alone: what `stagectl.stage.controller_kernel` does, line by line."""

SOURCE = r"""
#include <math.h>
#include <stdint.h>

typedef struct {
    int64_t phase;
    int64_t command;
    int64_t rising;
    int64_t ramp_at;
    int64_t ramp;
    int64_t states;
    int64_t servo_states;
    double observer[32][32];
    double drive[32];
    double correction[32];
    double feedback[32];
    double servo[12][12];
    double servo_error[12];
    double servo_tracking[12];
    double servo_feedback[12];
    double forward;
    double proportional;
    double integration;
    double tracking;
    double derivative;
    double derivative_pole;
    double direct;
    double reference_low;
    double reference_high;
    double extension_low;
    double extension_high;
    double extension_step;
    double voltage_low;
    double voltage_high;
    double voltage_step;
    double rest;
    double home;
    double position_zero;
    double extension_zero;
    double state[32];
    double next_state[32];
    double servo_state[12];
    double next_servo_state[12];
    double reference;
    double extension_reference;
    double integral;
    double slope;
    double error;
    double voltage;
    int64_t reference_limited;
    int64_t extension_limited;
    int64_t voltage_limited;
} Axis;

long size(void) { return (long)sizeof(Axis); }

static double least(double a, double b) { return b < a ? b : a; }
static double most(double a, double b) { return b > a ? b : a; }

static double limited(double value, double last, double step, double low, double high) {
    low = most(low, last - step);
    high = least(high, last + step);
    return least(most(value, low), high);
}

static double advanced(Axis *a) {
    if (a->rising && a->ramp_at < a->ramp) a->ramp_at++;
    else if (!a->rising && a->ramp_at > 0) a->ramp_at--;
    if (a->ramp_at == a->ramp) return 1.0;
    return 0.5 - 0.5 * cos(M_PI * a->ramp_at / a->ramp);
}

static double followed(Axis *a, double reference) {
    if (isnan(reference)) {
        reference = a->reference;
        a->reference_limited++;
    } else if (!(a->reference_low <= reference && reference <= a->reference_high)) {
        reference = least(most(reference, a->reference_low), a->reference_high);
        a->reference_limited++;
    }
    a->reference = reference;
    double weight = advanced(a);
    if (weight == 1.0) {
        a->home = a->rest;
        return reference;
    }
    return a->home + weight * (reference - a->home);
}

static void begin(Axis *a, double position, double extension) {
    for (int i = 0; i < a->states; i++) a->state[i] = 0.0;
    for (int i = 0; i < a->servo_states; i++) a->servo_state[i] = 0.0;
    a->position_zero = position;
    if (a->command == 1) {
        double within = least(most(extension, a->extension_low), a->extension_high);
        a->extension_zero = a->extension_reference = within;
        a->home = a->reference = position;
        a->ramp_at = 0;
        a->slope = 0.0;
        a->error = within - extension;
    } else {
        a->extension_zero = a->extension_reference;
    }
}

static double outer_sum(const Axis *a, double deviation) {
    double extension = a->extension_zero + a->forward * deviation;
    for (int i = 0; i < a->states; i++) extension -= a->feedback[i] * a->state[i];
    for (int i = 0; i < a->servo_states; i++) extension -= a->servo_feedback[i] * a->servo_state[i];
    return extension;
}

static double outer(Axis *a, double reference, double position) {
    double deviation = reference - a->position_zero, error = reference - position;
    if (a->command)
        a->servo_state[0] += (outer_sum(a, deviation) - a->extension_reference) / a->servo_feedback[0];
    double asked = outer_sum(a, deviation);
    double given = limited(asked, a->extension_reference, a->extension_step, a->extension_low, a->extension_high);
    a->extension_limited += given != asked;
    double drive = given - a->extension_zero, measured = position - a->position_zero;
    double excess = given - asked;
    long states = a->states, servo_states = a->servo_states;
    for (long i = 0; i < states; i++) {
        double total = a->drive[i] * drive + a->correction[i] * measured;
        for (long j = 0; j < states; j++) total += a->observer[i][j] * a->state[j];
        a->next_state[i] = total;
    }
    for (long i = 0; i < states; i++) a->state[i] = a->next_state[i];
    for (long i = 0; i < servo_states; i++) {
        double total = a->servo_error[i] * error + a->servo_tracking[i] * excess;
        for (long j = 0; j < servo_states; j++) total += a->servo[i][j] * a->servo_state[j];
        a->next_servo_state[i] = total;
    }
    for (long i = 0; i < servo_states; i++) a->servo_state[i] = a->next_servo_state[i];
    a->extension_reference = given;
    return given;
}

static double inner(Axis *a, double extension) {
    double error = a->extension_reference - extension;
    double slope = a->derivative_pole * a->slope + a->derivative * (error - a->error);
    double now = a->proportional * error + slope + a->direct * a->extension_reference;
    if (a->command) a->integral = a->voltage - now;
    double asked = now + a->integral;
    double given = limited(asked, a->voltage, a->voltage_step, a->voltage_low, a->voltage_high);
    a->voltage_limited += given != asked;
    a->integral += a->integration * error + a->tracking * (given - asked);
    a->slope = slope;
    a->error = error;
    a->voltage = given;
    return given;
}

void run(long frames, const double *reference, const double *position, const double *extension, double *request,
         double *extension_reference, Axis *axes, long width) {
    for (long n = 0; n < frames; n++)
        for (long number = 0; number < width; number++) {
            Axis *a = axes + number;
            long at = n * width + number;
            double measured = position[at], stretched = extension[at];
            if (a->phase == 0) {
                extension_reference[at] = stretched;
                request[at] = a->voltage;
                continue;
            }
            if (a->command == 1 || a->command == 3) begin(a, measured, stretched);
            double wanted = followed(a, reference[at]);
            extension_reference[at] = outer(a, wanted, measured);
            request[at] = inner(a, stretched);
            a->command = 0;
        }
}
"""
