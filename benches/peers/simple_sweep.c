/* The simple model of numpy_sweep.py in C, for this one arm: two rigid links, three given joints, stretched.
 *
 * Reads mass per length and rotary inertia per length of every section, as many as its argument says, and judges every pair.
 * Prints the number of designs, the processor time [s], and mass [kg], deflection [m] and lowest mode [Hz] of the lightest. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const double G = 9.81, K1 = 6.1e5, K2 = 6.1e5, K3 = 2.3e5, L1 = 0.8, L2 = 0.5;
static const double J2_KG = 12.2, J3_KG = 9.2, PAYLOAD_KG = 5.0, J1_KG = 20.0;

int main(int argc, char **argv) {
    long n = argc > 1 ? atol(argv[1]) : 0;
    double *line = malloc(n * sizeof *line), *rotary = malloc(n * sizeof *rotary);
    for (long i = 0; i < n; i++)
        if (scanf("%lf %lf", &line[i], &rotary[i]) != 2) return 1;
    double *kg = malloc(n * sizeof *kg), *tip = malloc(n * sizeof *tip), *hz = malloc(n * sizeof *hz);
    double best[3] = {INFINITY, 0, 0}, sum = 0;
    clock_t started = clock();
    for (long j = 0; j < n; j++) {
        double m2 = line[j] * L2;
        double about3 = line[j] * L2 * L2 * L2 / 3 + rotary[j] * L2 + PAYLOAD_KG * L2 * L2;
        double first3 = m2 * L2 / 2 + PAYLOAD_KG * L2, outer = J3_KG + m2 + PAYLOAD_KG;
        double c = about3 + L1 * first3, c2 = c * c / (K2 * K3), d = about3 / K3, t3 = G * first3;
        for (long i = 0; i < n; i++) {
            double m1 = line[i] * L1;
            double about2 = line[i] * L1 * L1 * L1 / 3 + rotary[i] * L1 + about3 + 2 * L1 * first3 + outer * L1 * L1;
            double a = about2 / K2, half = 0.5 * (a - d);
            double block = 0.5 * (a + d) + sqrt(half * half + c2), turning = about2 / K1;
            double t2 = G * (m1 * L1 / 2 + first3 + outer * L1);
            kg[i] = J1_KG + J2_KG + m1 + outer - PAYLOAD_KG;
            tip[i] = t2 / K2 * (L1 + L2) + t3 / K3 * L2;
            hz[i] = 1 / (6.283185307179586 * sqrt(block > turning ? block : turning));
        }
        for (long i = 0; i < n; i++) {
            sum += tip[i] + hz[i];
            if (kg[i] < best[0]) best[0] = kg[i], best[1] = tip[i], best[2] = hz[i];
        }
    }
    double seconds = (double)(clock() - started) / CLOCKS_PER_SEC;
    printf("%ld %.6f %.9f %.12f %.9f\n", n * n, seconds, best[0], best[1], best[2]);
    return sum == 0;
}
