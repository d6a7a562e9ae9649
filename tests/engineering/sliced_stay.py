"""A stay that moves in one mode, with a rivulet of its own on every slice: what the section is a model of."""

import numpy as np


class SlicedStay:
    """States: y, z, their rates, then phi of the n slices and their rates.

    model: the section at a wind of 1 times `speeds` (n,); shape (n,) of equal slices. Without the tension's spring.
    """

    def __init__(self, model, shape, speeds):
        self.model, self.shape = model, np.asarray(shape, dtype=float)
        self.p = dict(model.parameters) | {"wind.speed": np.asarray(speeds, dtype=float)}
        self.at = model.letters(self.p)
        self.share = self.shape / np.sum(self.shape**2)

    def rest(self, phi):
        """The equilibrium with the rivulets near phi (n,), each of which rests by itself."""
        phi, step = np.array(phi, dtype=float), 1e-6
        for _ in range(50):
            slope = (self._pull(phi + step) - self._pull(phi - step)) / (2 * step)
            phi = phi - self._pull(phi) / slope
        f_y, f_z, _ = self.model.wind_forces((0.0, phi, 0.0, 0.0, 0.0 * phi, 0.0), self.p)
        y, z = self.share @ f_y / self.at.k_y, self.share @ f_z / self.at.k_z
        return np.concatenate([[y, z, 0.0, 0.0], phi, np.zeros_like(phi)])

    def _pull(self, phi):
        moment = self.model.wind_forces((0.0, phi, 0.0, 0.0, 0.0 * phi, 0.0), self.p)[2]
        return moment + self.at.m_r * self.at.r * self.at.g_cos_delta * np.sin(phi + self.at.beta)

    def rates(self, state):
        """Their derivatives: eq. (4) of every slice, those of y and z added up with the shape."""
        at, v, n = self.at, self.shape, self.shape.size
        y, z, y_dot, z_dot = state[:4]
        phi, phi_dot = state[4 : 4 + n], state[4 + n :]
        f_y, f_z, moment = self.model.wind_forces((v * y, phi, v * z, v * y_dot, phi_dot, v * z_dot), self.p)
        s, c = np.sin(phi), np.cos(phi)
        turning = at.m_r * at.r * at.g_cos_delta * np.sin(phi + at.beta) + moment - at.d_phi * phi_dot
        # phi_ddot = turning / (m_r r²) - v (s y_ddot - c z_ddot) / r, put into the rows of y and z
        m_s, m_r, r = at.m_s, at.m_r, at.r
        p_y = self.share @ (f_y - s * turning / r - m_r * r * c * phi_dot**2) - at.k_y * y - at.d_y * y_dot
        p_z = self.share @ (f_z + c * turning / r - m_r * r * s * phi_dot**2) - at.k_z * z - at.d_z * z_dot
        weight = self.share * v
        mass = [
            [m_s + m_r - m_r * weight @ (s * s), m_r * weight @ (s * c)],
            [m_r * weight @ (s * c), m_s + m_r - m_r * weight @ (c * c)],
        ]
        y_ddot, z_ddot = np.linalg.solve(mass, [p_y, p_z])
        phi_ddot = turning / (m_r * r * r) - v * (s * y_ddot - c * z_ddot) / r
        return np.concatenate([[y_dot, z_dot, y_ddot, z_ddot], phi_dot, phi_ddot])

    def eigenvalues(self, state):
        """Of the linearised motion about a state of rest."""
        steps = np.eye(state.size) * 1e-6
        columns = [(self.rates(state + h) - self.rates(state - h)) / 2e-6 for h in steps]
        return np.linalg.eigvals(np.array(columns).T)
