"""The ankle-actuated compass walker once more, as an oracle for the system tests.

Written for these tests alone, from the walker's assumptions and in another way
than the C code: the equations of motion are not typed in but come from the
positions of the masses by numerical differentiation of the kinematics (complex
step), the constraints (locked heel, pinned toes) as Lagrange multipliers, the
impact as a projection, and SciPy's DOP853 integrates. Slow, and good to about
1e-8.

Signs: the walker moves towards -x, angles from the vertical, forward walking
has a negative stance rate; the ankle spring sits below the stance leg, whose
mass stays half a leg below the hip.
"""

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = 9.80665
STEP = 1e-30  # of the complex-step derivative: exact to rounding
DIFFERENCE = 1e-6


class Walker:
    def __init__(self, M=1.0, m=0.01, l=1.0, k=100.0):  # noqa: E741 (the usual names)
        self.M, self.m, self.l, self.k = M, m, l, k
        self.masses = np.array([M, M, m, m, m, m])

    def positions(self, q):
        """Hip, stance leg's mass, swing leg's mass: x, y of each, any number type."""
        stance, swing, r = q
        l = self.l  # noqa: E741
        hip = (l + r) * np.sin(stance), (l + r) * np.cos(stance)
        return np.array([hip[0], hip[1],
                         (r + l / 2) * np.sin(stance), (r + l / 2) * np.cos(stance),
                         hip[0] - l / 2 * np.sin(swing), hip[1] - l / 2 * np.cos(swing)])

    def swing_toe(self, q):
        stance, swing, r = q
        return np.array([(self.l + r) * np.sin(stance) - self.l * np.sin(swing),
                         (self.l + r) * np.cos(stance) - self.l * np.cos(swing)])

    @staticmethod
    def jacobian(function, q):
        columns = []
        for i in range(3):
            moved = np.array(q, dtype=complex)
            moved[i] += 1j * STEP
            columns.append(np.imag(function(moved)) / STEP)
        return np.array(columns).T

    def jacobian_rate(self, function, q, rate):
        """d/dt of the Jacobian along the motion, by central differences."""
        ahead = self.jacobian(function, q + DIFFERENCE * rate)
        behind = self.jacobian(function, q - DIFFERENCE * rate)
        return (ahead - behind) / (2 * DIFFERENCE)

    def accelerations(self, q, rate, spring_force, constraints):
        """q'' under the constraints, a list of functions q -> positions to hold."""
        J = self.jacobian(self.positions, q)
        dJ = self.jacobian_rate(self.positions, q, rate)
        mass = J.T @ (self.masses[:, None] * J)
        weight = np.zeros(6)
        weight[1::2] = -GRAVITY * self.masses[1::2]
        force = J.T @ (weight - self.masses * (dJ @ rate)) + np.array([0.0, 0.0, spring_force])
        held = np.vstack([self.jacobian(c, q) for c in constraints])
        held_rate = np.vstack([self.jacobian_rate(c, q, rate) for c in constraints])
        n = held.shape[0]
        system = np.block([[mass, -held.T], [held, np.zeros((n, n))]])
        return np.linalg.solve(system, np.concatenate([force, -held_rate @ rate]))[:3]

    @staticmethod
    def heel(q):
        return np.array([q[2]])

    def collide(self, q, rate):
        """Inelastic, slip-free strike of the swing toe; a heel cannot sink."""
        J = self.jacobian(self.positions, q)
        mass = J.T @ (self.masses[:, None] * J)
        toe = self.jacobian(self.swing_toe, q)
        inverse = np.linalg.inv(mass)
        after = rate - inverse @ toe.T @ np.linalg.solve(toe @ inverse @ toe.T, toe @ rate)
        return np.zeros(3) if after[2] < 0 else after

    def flow(self, q, rate, spring_rest, constraints, event, limit_s):
        """Until event(q, rate) crosses zero downwards, from a moment later on."""
        def derivative(_, y):
            force = self.k * (spring_rest - y[2]) if spring_rest is not None else 0.0
            return np.concatenate([y[3:], self.accelerations(y[:3], y[3:], force, constraints)])

        def crossing(_, y):
            return event(y[:3], y[3:])
        crossing.terminal, crossing.direction = True, -1
        solution = solve_ivp(derivative, (0.0, limit_s), np.concatenate([q, rate]), method="DOP853",
                             rtol=1e-10, atol=1e-12, events=crossing, max_step=0.05)
        if not len(solution.t_events[0]):
            raise ValueError("no event: the walker fell or stood still")
        y = solution.y_events[0][0]
        return solution.t_events[0][0], y[:3], y[3:]

    def step(self, apex, r0):
        """From apex to apex: (stance rate, swing angle, swing rate) -> the next, step time."""
        q = np.array([0.0, apex[1], 0.0])
        rate = np.array([apex[0], apex[2], 0.0])

        # The toe strikes where the sum of the angles falls through zero; at the
        # scuff in mid-stance, which is ignored, it rises.
        t1, q, rate = self.flow(q, rate, None, [self.heel], lambda q, _: q[0] + q[1], 5.0)
        rate = self.collide(q, rate)
        held = self.swing_toe(q)
        t2, q, rate = self.flow(q, rate, r0, [lambda x: self.swing_toe(x) - held],
                                lambda q, _: r0 - q[2], 5.0)
        q, rate = np.array([q[1], q[0], 0.0]), np.array([rate[1], rate[0], 0.0])
        if q[0] <= 0 or rate[0] >= 0:
            raise ValueError("lift-off past the apex, or walking backwards")
        t3, q, rate = self.flow(q, rate, None, [self.heel], lambda q, _: q[0], 5.0)
        return np.array([rate[0], q[1], rate[1]]), t1 + t2 + t3


def orbit(walker, apex, r0_by_step):
    """The apex speeds (forward positive) along a sequence of r0."""
    speeds = []
    for r0 in r0_by_step:
        apex, _ = walker.step(apex, r0)
        speeds.append(-apex[0])
    return speeds


PAPER_GAIT = np.array([-0.406960, -0.059569, 1.756768])  # the fixed point at r0 = 0.05
