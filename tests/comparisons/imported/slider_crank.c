/* The functions of an FMU (FMI 2 and 3) that do anything: the slider-crank of foreign/slider-crank.toml at
   60 rad/s, its torque by the power of its parts. PISTON is the piston's mass, kg; DO what a step does besides. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double now;

/* rad, rad/s, N m, mm, mm: the crank's angle, the rod's speed, the torque, x and y of C. */
static void evaluate(double *out)
{
    double r = 0.032, l = 0.12, g = 0.045, e = 0.012, w = 60.0, phi = w * now, c = cos(phi), s = sin(phi);
    double sb = (e - r * s) / l, cb = sqrt(1.0 - sb * sb);
    double b1 = -r * c / (l * cb), b2 = (r * s + l * sb * b1 * b1) / (l * cb);
    double x1 = -r * s - l * sb * b1, x2 = -r * c - l * (cb * b1 * b1 + sb * b2);
    double gx1 = -r * s - g * sb * b1, gx2 = -r * c - g * (cb * b1 * b1 + sb * b2);
    double gy1 = r * c + g * cb * b1, gy2 = -r * s + g * (cb * b2 - sb * b1 * b1);
    double power = PISTON * x1 * x2 + 0.3 * (gx1 * gx2 + gy1 * gy2) + 420e-6 * b1 * b2;
    double values[] = {phi, w * b1, w * w * power + 9.81 * 0.3 * gy1, 1000.0 * (r * c + l * cb), 1000.0 * e};
    memcpy(out, values, sizeof values);
}

static void *begin(void) { now = 0.0; return &now; }
static int step(double to) { now = to; DO; return 0; }

void *fmi2Instantiate(void) { return begin(); }
void *fmi3InstantiateCoSimulation(void) { return begin(); }
int fmi2DoStep(void *model, double from, double by) { return step(from + by); }
int fmi3DoStep(void *model, double from, double by) { return step(from + by); }
int fmi2SetTime(void *model, double to) { return step(to); }

int fmi2GetReal(void *model, const unsigned *of, size_t n, double *to)
{
    double out[5];
    evaluate(out);
    for (size_t k = 0; k < n; k++) to[k] = out[of[k]];
    return 0;
}

/* Variable 4 is the place of C, two numbers. */
int fmi3GetFloat64(void *model, const unsigned *of, size_t n, double *to, size_t size)
{
    double out[5];
    evaluate(out);
    for (size_t k = 0; k < n; k++) {
        if (of[k] == 4) *to++ = out[3];
        *to++ = out[of[k]];
    }
    return 0;
}
