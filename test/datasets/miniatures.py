"""Short recordings in the forms of six data sets, made of simulated ones; and a reading of them that shares no code with the
package: stamps [ns], exposures [s, None = unknown] and true poses of the camera {stamp [s]: 4x4 matrix as rows}."""
import csv
import math
import os
import pathlib

NS = 1000000000


def rows_of(file):
    with open(file, encoding="utf-8") as stream:
        return [line.split() for line in stream if line.strip() and not line.startswith("#")]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(m):
    turned = [[m[j][i] for j in range(3)] for i in range(3)]
    return [row + [-sum(row[k] * m[k][3] for k in range(3))] for row in turned] + [[0.0, 0.0, 0.0, 1.0]]


def matrix(x, y, z, qx, qy, qz, qw):
    n = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
    qx, qy, qz, qw = qx / n, qy / n, qz / n, qw / n
    return [[1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw), x],
            [2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw), y],
            [2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy), z], [0.0, 0.0, 0.0, 1.0]]


def quaternion(m):
    """x y z w, for turns of less than 180 degrees in the halves that matter: the largest of the four is divided by."""
    squares = [1 + m[0][0] - m[1][1] - m[2][2], 1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2],
               1 + m[0][0] + m[1][1] + m[2][2]]
    most = max(range(4), key=lambda i: squares[i])
    s = 2.0 * math.sqrt(squares[most])
    x, y, z = m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]
    if most == 3:
        return x / s, y / s, z / s, s / 4
    i, j, k = most, (most + 1) % 3, (most + 2) % 3
    q = [0.0, 0.0, 0.0, (x, y, z)[i] / s]
    q[i], q[j], q[k] = s / 4, (m[i][j] + m[j][i]) / s, (m[i][k] + m[k][i]) / s
    return tuple(q)


class Simulated:
    """What mba_vo_simulate wrote."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.times = [(int(i), int(t.split(".")[0]) * NS + int(t.split(".")[1].ljust(9, "0")), float(e))
                      for i, t, e in rows_of(self.folder / "times.txt")]
        self.poses = [matrix(*map(float, row[1:])) for row in rows_of(self.folder / "groundtruth.txt")]

    def link(self, number, file):
        file.parent.mkdir(parents=True, exist_ok=True)
        os.link(self.folder / "images" / ("%06d.png" % number), file)


def _write(file, text):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


def _seconds(ns, digits=6):
    return "%d.%s" % (ns // NS, ("%09d" % (ns % NS))[:digits])


def _tum_poses(simulated, digits=6):
    text = "# ground truth trajectory\n# file: 'x.bag'\n# timestamp tx ty tz qx qy qz qw\n"
    for (_, stamp, _), pose in zip(simulated.times, simulated.poses):
        text += "%s %s\n" % (_seconds(stamp, digits), " ".join("%.9f" % v for v in (*(pose[i][3] for i in range(3)), *quaternion(pose))))
    return text


# Body to camera of the ASL forms: turned about two axes and shifted.
T_BS = matrix(-0.02, 0.06, 0.01, 0.5, -0.5, 0.5, 0.5)


def _asl(simulated, root, poses, camera_yaml):
    cam = root / "mav0" / "cam0"
    _write(cam / "data.csv", "#timestamp [ns],filename\r\n" + "".join("%d,%d.png\r\n" % (t, t) for _, t, _ in simulated.times))
    for number, stamp, _ in simulated.times:
        simulated.link(number, cam / "data" / ("%d.png" % stamp))
    if camera_yaml:
        _write(cam / "sensor.yaml", camera_yaml)
    text = ("#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1]\n")
    for (_, stamp, _), pose in zip(simulated.times, simulated.poses):
        body = product(pose, inverse(T_BS))
        x, y, z, w = quaternion(body)
        text += "%d,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,0.1\n" % (stamp, body[0][3], body[1][3], body[2][3], w, x, y, z)
    _write(root / "mav0" / poses / "data.csv", text)


def _numbers(m):
    return ", ".join("%.12f" % v for row in m for v in row)


def euroc(simulated, root, intrinsics, size, distortion):
    _asl(simulated, root, "state_groundtruth_estimate0",
         "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [%s]\nrate_hz: 20\nresolution: %s\ncamera_model: pinhole\n"
         "intrinsics: %s\ndistortion_model: radial-tangential\ndistortion_coefficients: %s\n" %
         (_numbers(T_BS), size, intrinsics, distortion))


def tum_vi(simulated, root, intrinsics, size, distortion):
    _asl(simulated, root, "mocap0", None)
    lists = "".join("  - [%s]\n" % ", ".join("%.12f" % v for v in row) for row in inverse(T_BS))
    _write(root / "dso" / "camchain.yaml",
           "cam0:\n  T_cam_imu:\n%s  camera_model: pinhole\n  distortion_coeffs: %s\n  distortion_model: equidistant\n  intrinsics: %s\n"
           "  resolution: %s\n  rostopic: /cam0/image_raw\n" % (lists, distortion, intrinsics, size))
    _write(root / "dso" / "cam0" / "times.txt",
           "# timestamp[ns] timestamp[s] exposure[ms]\n" + "".join("%d %s %.5f\n" % (t, _seconds(t, 9), e) for _, t, e in simulated.times))


def tum_mono(simulated, root, intrinsics, size, omega):
    fx, fy, cx, cy = intrinsics[0] / size[0], intrinsics[1] / size[1], (intrinsics[2] + 0.5) / size[0], (intrinsics[3] + 0.5) / size[1]
    _write(root / "camera.txt", "%.9f %.9f %.9f %.9f %s\n%d %d\ncrop\n%d %d\n" % (fx, fy, cx, cy, omega, *size, *size))
    _write(root / "pcalib.txt", " ".join("%d.0" % i for i in range(256)) + "\n")
    _write(root / "times.txt", "".join("%05d %s0 %.10f\n" % (i, _seconds(t, 9), e) for i, t, e in simulated.times))
    lines = _tum_poses(simulated, 9).splitlines()
    unknown = [line.split()[0] + " NaN" * 7 if 6 < i < len(lines) - 4 else line for i, line in enumerate(lines)]
    _write(root / "groundtruthSync.txt", "\n".join(unknown[3:]) + "\n")
    for number, _, _ in simulated.times:
        simulated.link(number, root / "images" / ("%05d.png" % number))


def tum_rgbd(simulated, root):
    head = "# color images\n# file: 'x.bag'\n# timestamp filename\n"
    _write(root / "rgb.txt", head + "".join("%s rgb/%s.png\n" % (_seconds(t), _seconds(t)) for _, t, _ in simulated.times))
    for number, stamp, _ in simulated.times:
        simulated.link(number, root / "rgb" / (_seconds(stamp) + ".png"))
    _write(root / "groundtruth.txt", _tum_poses(simulated))


def eth3d(simulated, root, intrinsics):
    tum_rgbd(simulated, root)
    _write(root / "calibration.txt", " ".join("%.9f" % v for v in intrinsics) + "\n")


def seven_scenes(simulated, root):
    for (number, _, _), pose in zip(simulated.times, simulated.poses):
        simulated.link(number, root / ("frame-%06d.color.png" % number))
        _write(root / ("frame-%06d.pose.txt" % number), "".join("\t".join("%.9e" % v for v in row) + "\t\n" for row in pose))


def _ns(text):
    whole, _, rest = text.partition(".")
    return int(whole) * NS + int((rest + "000000000")[:9])


def read_rgbd(root):
    return ([_ns(row[0]) for row in rows_of(root / "rgb.txt")], None,
            {float(row[0]): matrix(*map(float, row[1:])) for row in rows_of(root / "groundtruth.txt")})


def read_mono(root):
    times = rows_of(root / "times.txt")
    poses = {float(row[0]): matrix(*map(float, row[1:])) for row in rows_of(root / "groundtruthSync.txt") if row[1] != "NaN"}
    return [_ns(row[1]) for row in times], [float(row[2]) / 1000 for row in times], poses


def read_asl(root, poses, exposures=False):
    with open(root / "mav0" / "cam0" / "data.csv", newline="", encoding="utf-8") as stream:
        stamps = [int(row[0]) for row in csv.reader(stream) if not row[0].startswith("#")]
    true = {}
    with open(root / "mav0" / poses / "data.csv", newline="", encoding="utf-8") as stream:
        for row in csv.reader(stream):
            if not row[0].startswith("#"):
                x, y, z, qw, qx, qy, qz = map(float, row[1:8])
                true[int(row[0]) / NS] = product(matrix(x, y, z, qx, qy, qz, qw), T_BS)
    told = {int(row[0]): float(row[2]) / 1000 for row in rows_of(root / "dso" / "cam0" / "times.txt")} if exposures else {}
    return stamps, [told[stamp] for stamp in stamps] if exposures else None, true


def read_seven_scenes(root):
    stamps, poses = [], {}
    for file in sorted(root.glob("frame-*.color.png")):
        number = int(file.name[6:12])
        stamps.append(round(number * NS / 30))
        values = (root / ("frame-%06d.pose.txt" % number)).read_text().split()
        poses[number / 30] = [[float(v) for v in values[4 * i:4 * i + 4]] for i in range(4)]
    return stamps, None, poses
