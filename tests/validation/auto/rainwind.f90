! The cable with a moving rivulet, Peil & Nahrath (2003), eqs. (2)-(5), for AUTO-07p.
!
! Written from the paper alone and sharing nothing with the Python package, so that it can serve as a check.
! The sample case of section 3 with damping 0.2 %, yaw 0, U_rel = U, angle of attack with atan2, and the
! coefficients of the set "reconstructed" as plain polynomials (not blended outside their range, not wrapped).
!
!   U(1..6) = y, phi, z, y_dot, phi_dot, z_dot        PAR(1) = wind speed, m/s
!                                                     PAR(2) = damping ratio in y and in z
module sample_case
  implicit none
  double precision, parameter :: pi = 3.141592653589793238d0, g = 9.81d0, rho = 1.225d0
  double precision, parameter :: d = 0.1d0, h = 0.01d0, r = (d + h) / 2
  double precision, parameter :: m_s = 50d0, m_r = 0.2d0, m = m_s + m_r, omega = 2 * pi * 1d0
  double precision, parameter :: k = m_s * omega**2, k2_y = 0.0077d0, k3 = 0.00115d0
  double precision, parameter :: d_phi = 0.05d0, delta = pi / 4
  ! c0 + c1 alpha + ... + c4 alpha^4, alpha in rad: the set "reconstructed"
  double precision, parameter :: lift(0:4) = [1.31724d0, 13.22028d0, 21.9629d0, 10.78773d0, 0.89058d0]
  double precision, parameter :: drag(0:4) = [1.77928d0, 5.2367d0, 7.17321d0, 1.7873d0, -0.47775d0]
  double precision, parameter :: moment(0:4) = [0.043d0, -0.19821d0, -0.74154d0, -0.19402d0, 0.14268d0]
contains
  pure subroutine polynomial(c, x, value, slope)
    double precision, intent(in) :: c(0:4), x
    double precision, intent(out) :: value, slope
    value = c(0) + x * (c(1) + x * (c(2) + x * (c(3) + x * c(4))))
    slope = c(1) + x * (2 * c(2) + x * (3 * c(3) + x * 4 * c(4)))
  end subroutine polynomial
end module sample_case

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use sample_case
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: y, z, vy, w, vz, speed, damping, s, c, s_v, c_v, n, e, alpha, alpha_v, q
  double precision :: c_l, c_d, c_m, c_l1, c_d1, c_m1, f_y, f_z, moment_phi, b_y, b_phi, b_z, inertia
  double precision :: a_y, a_phi, a_z
  ! derivatives with respect to u(1..6), the wind speed (7) and the damping ratio (8)
  double precision, dimension(8) :: n1, e1, v1, alpha1, f_y1, f_z1, b_y1, b_phi1, b_z1, a_y1, a_phi1, a_z1

  y = u(1); z = u(3); vy = u(4); w = u(5); vz = u(6)
  speed = par(1)
  damping = 2 * par(2) * m_s * omega
  s = sin(u(2)); c = cos(u(2))

  n = vy + r * w * s                       ! eq. (3): the wind relative to the moving rivulet
  e = speed - vz + r * w * c
  alpha_v = atan2(n, e)
  alpha = -u(2) + alpha_v
  s_v = sin(alpha_v); c_v = cos(alpha_v)
  call polynomial(lift, alpha, c_l, c_l1)
  call polynomial(drag, alpha, c_d, c_d1)
  call polynomial(moment, alpha, c_m, c_m1)

  q = rho / 2 * d * speed**2
  f_y = -q * (c_l * c_v + c_d * s_v)       ! eq. (2)
  f_z = q * (-c_l * s_v + c_d * c_v)
  moment_phi = q * d * c_m

  ! eq. (4) with everything but the accelerations on the right, then solved for them
  b_y = f_y - damping * vy - k * y - k2_y * y**2 - k3 * y**3 - m_r * r * c * w**2
  b_z = f_z - damping * vz - k * z - k3 * z**3 - m_r * r * s * w**2
  b_phi = moment_phi - d_phi * w + m_r * r * g * cos(delta) * s
  inertia = m_r * r**2 * m_s / m
  a_phi = (b_phi - m_r * r / m * (s * b_y - c * b_z)) / inertia
  a_y = (b_y - m_r * r * s * a_phi) / m
  a_z = (b_z + m_r * r * c * a_phi) / m
  f(1) = vy; f(2) = w; f(3) = vz; f(4) = a_y; f(5) = a_phi; f(6) = a_z
  if (ijac == 0) return

  n1 = 0; e1 = 0; alpha1 = 0
  n1(2) = r * w * c; n1(4) = 1; n1(5) = r * s
  e1(2) = -r * w * s; e1(5) = r * c; e1(6) = -1; e1(7) = 1
  v1 = (e * n1 - n * e1) / (n**2 + e**2)
  alpha1 = v1
  alpha1(2) = alpha1(2) - 1
  f_y1 = -q * ((c_l1 * c_v + c_d1 * s_v) * alpha1 + (-c_l * s_v + c_d * c_v) * v1)
  f_z1 = q * ((-c_l1 * s_v + c_d1 * c_v) * alpha1 - (c_l * c_v + c_d * s_v) * v1)
  b_phi1 = q * d * c_m1 * alpha1
  f_y1(7) = f_y1(7) + 2 * f_y / speed
  f_z1(7) = f_z1(7) + 2 * f_z / speed
  b_phi1(7) = b_phi1(7) + 2 * moment_phi / speed

  b_y1 = f_y1; b_z1 = f_z1
  b_y1(1) = b_y1(1) - k - 2 * k2_y * y - 3 * k3 * y**2
  b_z1(3) = b_z1(3) - k - 3 * k3 * z**2
  b_y1(4) = b_y1(4) - damping
  b_z1(6) = b_z1(6) - damping
  b_y1(5) = b_y1(5) - 2 * m_r * r * c * w
  b_z1(5) = b_z1(5) - 2 * m_r * r * s * w
  b_y1(2) = b_y1(2) + m_r * r * s * w**2
  b_z1(2) = b_z1(2) - m_r * r * c * w**2
  b_y1(8) = -2 * m_s * omega * vy
  b_z1(8) = -2 * m_s * omega * vz
  b_phi1(5) = b_phi1(5) - d_phi
  b_phi1(2) = b_phi1(2) + m_r * r * g * cos(delta) * c

  a_phi1 = b_phi1 - m_r * r / m * (s * b_y1 - c * b_z1)
  a_phi1(2) = a_phi1(2) - m_r * r / m * (c * b_y + s * b_z)
  a_phi1 = a_phi1 / inertia
  a_y1 = b_y1 - m_r * r * s * a_phi1
  a_y1(2) = a_y1(2) - m_r * r * c * a_phi
  a_z1 = b_z1 + m_r * r * c * a_phi1
  a_z1(2) = a_z1(2) - m_r * r * s * a_phi
  dfdu(1:3, 1:6) = 0
  dfdu(1, 4) = 1; dfdu(2, 5) = 1; dfdu(3, 6) = 1
  dfdu(4, 1:6) = a_y1(1:6) / m
  dfdu(5, 1:6) = a_phi1(1:6)
  dfdu(6, 1:6) = a_z1(1:6) / m
  if (ijac == 1) return
  dfdp(1:3, 1:2) = 0
  dfdp(4, 1:2) = a_y1(7:8) / m
  dfdp(5, 1:2) = a_phi1(7:8)
  dfdp(6, 1:2) = a_z1(7:8) / m
end subroutine func

subroutine stpnt(ndim, u, par, t)
  ! A point near branch D at 25 m/s; Newton does the rest.
  use sample_case
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  double precision :: c_l, c_d, c_m, slope, q, phi, residual, residual1
  integer :: i
  par(1) = 25d0
  par(2) = 0.002d0
  q = rho / 2 * d * par(1)**2
  phi = 0.5d0
  do i = 1, 20                             ! the static balance of the rivulet, eq. (4)
    call polynomial(moment, -phi, c_m, slope)
    residual = q * d * c_m + m_r * r * g * cos(delta) * sin(phi)
    residual1 = -q * d * slope + m_r * r * g * cos(delta) * cos(phi)
    phi = phi - residual / residual1
  end do
  call polynomial(lift, -phi, c_l, slope)
  call polynomial(drag, -phi, c_d, slope)
  u(1:6) = [-q * c_l / k, phi, q * c_d / k, 0d0, 0d0, 0d0]
end subroutine stpnt

subroutine bcnd
end subroutine bcnd

subroutine icnd
end subroutine icnd

subroutine fopt
end subroutine fopt

subroutine pvls
end subroutine pvls
