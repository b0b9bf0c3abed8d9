#!/bin/sh
# tables.sh: Tables 4.1 to 5.5 of Sedef 2008 as data/sedef2008/compare.py finds them: no column is farther off than today, in
# percent or percentage points. check: once
. tests/cli/common

tables 4.1 4.2 4.3 4.4 4.5 5.1 5.2 5.3 5.4 5.5 5.7-peaks 5.8-peaks <<'LIMITS'
4.1 f1_N 0.26 of 4
4.1 f2_N 3.1 of 4
4.1 residual_N 6.1 of 4
4.1 f3_N 12 of 4
4.1 f4_N 5.9 of 4
4.1 f5_N 0.02 of 4
4.2 Kinf_N 0.35 of 12
4.2 K1_N 11 of 12
4.2 b1_Ns 20 of 12
4.3 Kinf_N 0.02 of 12
4.3 K1_N 0.02 of 12
4.3 b1_Ns 0.02 of 12
4.3 K2_N 0.02 of 12
4.3 b2_Ns 0.02 of 12
4.4 K1_N 23 of 1
4.4 b1_Ns 24 of 1
4.5 K1_N 5.5 of 1
4.5 b1_Ns 0.52 of 1
4.5 K2_N 1.1 of 1
4.5 b2_Ns 0.97 of 1
5.1 optimum_c0_N 1.4 of 10
5.1 optimum_c1_N 4.4 of 10
5.1 optimum_c2_N 3.1 of 10
5.1 optimum_c3_N 2.8 of 10
5.1 optimum_c4_N 2.1 of 10
5.1 residual_N 27 of 10
5.2 K1_N 1.7 of 15
5.2 b1_Ns 1.7 of 15
5.2 peak_error_percent 0.39 of 15
5.3 b1_Ns 1.7 of 4
5.3 steady_time_error_percent 1 of 4
5.4 c0_N 0.53 of 2
5.4 c1_N 0.53 of 2
5.4 c2_N 0.38 of 2
5.4 c3_N 0.4 of 2
5.4 c4_N 0.4 of 2
5.4 steady_force_error_percent 0.34 of 2
5.5 K1_N 0.46 of 1
5.5 b1_Ns 0.38 of 1
5.5 c0_N 0.53 of 1
5.5 c1_N 0.53 of 1
5.5 c2_N 0.38 of 1
5.5 c3_N 0.4 of 1
5.5 c4_N 0.4 of 1
5.5 peak_error_percent 0.094 of 1
5.5 steady_time_error_percent 0.052 of 1
5.5 steady_force_error_percent 0.64 of 1
5.7-peaks peak_N 1.7 of 15
5.8-peaks peak_N 2.7 of 15
LIMITS
done_testing
