"""DICOM series that tests make by pydicom. Importing it exits with 77 if pydicom is not installed."""

import os
import sys

try:
    import numpy
    import pydicom
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.fileset import FileSet
except ImportError as missing:
    print(f"skipped: {missing}; it is in the package python3-pydicom")
    sys.exit(77)

CT = "1.2.840.10008.5.1.4.1.1.2"
SECONDARY = "1.2.840.10008.5.1.4.1.1.7"
ROOT = "1.2.826.0.1.3680043.2.1125.9"
EDGE = 32
AXIAL, CORONAL = (1, 0, 0, 0, 1, 0), (1, 0, 0, 0, 0, -1)


class Series:
    """What a series consists of; members may be changed before write()."""

    def __init__(self, number, slices=4):
        self.uid = f"{ROOT}.{number}"
        self.number, self.slices = number, slices
        self.patient, self.description, self.charset = "Doe^Jane", f"series {number}", None
        self.modality, self.date = "CT", "20240331"
        self.colour = False
        # Of its images, in turn.
        self.orientations, self.edges = [AXIAL], [EDGE]

    def image(self, index):
        """A ball whose brightness differs from series to series."""
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID = SECONDARY if self.colour else CT
        meta.MediaStorageSOPInstanceUID = f"{self.uid}.{index}"
        meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
        meta.ImplementationClassUID = "1.2.3.4"
        image = FileDataset("", {}, file_meta=meta, preamble=bytes(128))
        image.is_little_endian, image.is_implicit_VR = True, False
        if self.charset:
            image.SpecificCharacterSet = self.charset
        image.SOPClassUID = meta.MediaStorageSOPClassUID
        image.SOPInstanceUID = meta.MediaStorageSOPInstanceUID
        image.PatientName, image.PatientID = self.patient, "42"
        image.StudyInstanceUID, image.StudyID, image.StudyTime = f"{ROOT}.0", "1", "120000"
        image.StudyDate, image.SeriesInstanceUID = self.date, self.uid
        image.SeriesNumber, image.SeriesDescription = self.number, self.description
        image.Modality, image.InstanceNumber = self.modality, index + 1
        orientation = self.orientations[index % len(self.orientations)]
        normal = numpy.cross(orientation[:3], orientation[3:])
        image.ImageOrientationPatient = list(orientation)
        image.ImagePositionPatient = [float(x) for x in normal * index]
        image.PixelSpacing, image.SliceThickness = [1, 1], 1
        edge = image.Rows = image.Columns = self.edges[index % len(self.edges)]
        z, y, x = index - self.slices / 2, *numpy.mgrid[0:edge, 0:edge] - edge / 2
        ball = numpy.maximum(0, 1 - (x * x + y * y + z * z) ** 0.5 / (0.45 * edge))
        if self.colour:
            image.SamplesPerPixel, image.PhotometricInterpretation = 3, "RGB"
            image.PlanarConfiguration, bits = 0, 8
            pixels = numpy.repeat((250 * ball).astype("u1")[..., None], 3, axis=2)
        else:
            image.SamplesPerPixel, image.PhotometricInterpretation = 1, "MONOCHROME2"
            bits, pixels = 16, (1000 * self.number * ball).astype("<u2")
        image.BitsAllocated = image.BitsStored = bits
        image.HighBit, image.PixelRepresentation = bits - 1, 0
        image.PixelData = pixels.tobytes()
        return image

    def write(self, folder):
        """Write its files into a folder. -> their paths"""
        os.makedirs(folder, exist_ok=True)
        paths = []
        for index in range(self.slices):
            path = os.path.join(folder, f"{self.number}-{index:02}.dcm")
            self.image(index).save_as(path, write_like_original=False)
            paths.append(path)
        return paths


def write_medium(folder, *all_series):
    """Write a medium with a DICOMDIR. -> path of the DICOMDIR"""
    files = FileSet()
    for series in all_series:
        for index in range(series.slices):
            files.add(series.image(index))
    files.write(folder)
    return os.path.join(folder, "DICOMDIR")
