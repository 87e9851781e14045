(* SPDX-License-Identifier: BSD-3-Clause *)
(** * That a claim is about something

    Nine numbers mean any rotation near them, and three numbers a unit vector: here the checker makes sure that there is
    one. A rotation is found by a quaternion of integers, whose matrix is compared exactly. *)
From Coq Require Import Reals ZArith Lia Lra Bool List FunctionalExtensionality.
From FclArtic Require Import Statement Numbers Frames Enclose Reach Tube.
Import ListNotations.
Open Scope R_scope.

Record quaternion := Quaternion { qa : Z; qb : Z; qc : Z; qd : Z }.

Definition square (q : quaternion) : Z := (qa q * qa q + qb q * qb q + qc q * qc q + qd q * qd q)%Z.

(** The matrix of a quaternion, times its square. *)
Definition entries (q : quaternion) : list (list Z) :=
  let '(Quaternion a b c d) := q in
  [[a * a + b * b - c * c - d * d; 2 * (b * c - a * d); 2 * (b * d + a * c)];
   [2 * (b * c + a * d); a * a - b * b + c * c - d * d; 2 * (c * d - a * b)];
   [2 * (b * d - a * c); 2 * (c * d + a * b); a * a - b * b - c * c + d * d]]%Z.

(** Whether |e / n - x| <= 2^-49. *)
Definition is_near (n e : Z) (x : number) : bool :=
  let k := Z.max 0 (- exponent x) in
  Z.leb (Z.abs (e * 2 ^ k - n * aligned (- k) x) * 2 ^ 49) (n * 2 ^ k).

Definition row_is_near (n : Z) (es : list Z) (r : numbers3) : bool :=
  match es with [x; y; z] => is_near n x (n1 r) && is_near n y (n2 r) && is_near n z (n3 r) | _ => false end.

Definition matrix_is_near (p : stated_pose) (q : quaternion) : bool :=
  Z.ltb 0 (square q) &&
  match entries q with
  | [x; y; z] =>
      row_is_near (square q) x (r1 p) && row_is_near (square q) y (r2 p) && row_is_near (square q) z (r3 p)
  | _ => false
  end.

(** Four ways to the quaternion of a matrix, of which one at least is precise. *)
Definition candidates (p : stated_pose) : list quaternion :=
  let f x := fst (enclose x) in
  let a11 := f (n1 (r1 p)) in let a12 := f (n2 (r1 p)) in let a13 := f (n3 (r1 p)) in
  let a21 := f (n1 (r2 p)) in let a22 := f (n2 (r2 p)) in let a23 := f (n3 (r2 p)) in
  let a31 := f (n1 (r3 p)) in let a32 := f (n2 (r3 p)) in let a33 := f (n3 (r3 p)) in
  [Quaternion (one + a11 + a22 + a33) (a32 - a23) (a13 - a31) (a21 - a12);
   Quaternion (a32 - a23) (one + a11 - a22 - a33) (a12 + a21) (a13 + a31);
   Quaternion (a13 - a31) (a12 + a21) (one - a11 + a22 - a33) (a23 + a32);
   Quaternion (a21 - a12) (a13 + a31) (a23 + a32) (one - a11 - a22 + a33)]%Z.

Definition has_rotation (p : stated_pose) : bool := existsb (matrix_is_near p) (candidates p).

Definition has_direction (a : numbers3) : bool :=
  negb (Z.eqb (mantissa (n1 a)) 0 && Z.eqb (mantissa (n2 a)) 0 && Z.eqb (mantissa (n3 a)) 0).
Definition element_means (e : element) : bool :=
  match e with Turn a _ _ _ => has_direction a | Slide a _ _ _ => has_direction a | Rotate _ => true end.
Definition frame_means (f : frame) : bool := has_rotation (origin f) && forallb element_means (elements f).

Definition nothing : numbers3 := let zero := Number 0 0 in Numbers3 zero zero zero.
Definition piece_means (p : piece) : bool :=
  forallb (fun o => let '(a, b, c) := snd o in has_rotation (Stated a b c nothing)) (orientations p).

(** A tolerance below 0 would leave nothing within it. *)
Definition not_below_0 (x : number) : bool := Z.leb 0 (mantissa x).
Definition all_not_below_0 (list : list (nat * number)) : bool := forallb (fun e => not_below_0 (snd e)) list.
Definition pose_tolerance_means (t : pose_tolerance) : bool := not_below_0 (most_shift t) && not_below_0 (most_angle t).
Definition tolerances_mean (t : tolerances) : bool :=
  all_not_below_0 (of_variables t) && all_not_below_0 (of_vectors t) && all_not_below_0 (of_rotations t) &&
  forallb (fun e => pose_tolerance_means (snd e)) (of_frames t) && forallb (fun e => pose_tolerance_means (snd e)) (of_bodies t).

(** ** Proofs *)

Lemma not_below_0_ok x : not_below_0 x = true -> 0 <= real x.
Proof.
  intros H. apply Z.leb_le, IZR_le in H. unfold real. apply Rmult_le_pos; [exact H | left; apply powerRZ_lt; lra].
Qed.

Lemma most_not_below_0 list i : all_not_below_0 list = true -> 0 <= most list i.
Proof.
  unfold all_not_below_0, most. rewrite forallb_forall. intros H. destruct (find _ list) as [e|] eqn:F; [|lra].
  apply not_below_0_ok, H. exact (proj1 (find_some _ _ F)).
Qed.

Lemma no_turn most : 0 <= most -> small_turn most (fun x => x).
Proof.
  intros H. exists (Vec 1 0 0), 0. split; [unfold dot; cbn [vx vy vz]; ring|].
  split; [rewrite Rabs_R0; exact H | intros x; rewrite turn_zero; reflexivity].
Qed.

Lemma not_off t : (forall x, t = Some x -> pose_tolerance_means x = true) -> pose_off t (fun x => x).
Proof.
  destruct t as [t|]; cbn [pose_off]; [|reflexivity]. intros H. specialize (H t eq_refl).
  apply andb_true_iff in H. destruct H as [H1 H2]. apply not_below_0_ok in H1, H2.
  exists (fun x => x), (Vec 0 0 0). split; [apply no_turn; exact H2|]. split; [rewrite norm_zero; exact H1|].
  intros x. destruct x. coords. f_equal; ring.
Qed.

Lemma tolerance_found {T} (f : T * pose_tolerance -> bool) list t : forallb (fun e => pose_tolerance_means (snd e)) list = true ->
  option_map snd (find f list) = Some t -> pose_tolerance_means t = true.
Proof.
  rewrite forallb_forall. intros H. destruct (find f list) as [e|] eqn:F; [|discriminate]. cbn [option_map].
  intros [= <-]. apply H. exact (proj1 (find_some _ _ F)).
Qed.

Lemma is_near_ok n e x : (0 < n)%Z -> is_near n e x = true -> Rabs (IZR e / IZR n - real x) <= / 2 ^ 49.
Proof.
  intros Hn H. unfold is_near in H. set (k := Z.max 0 (- exponent x)) in *. apply Z.leb_le in H.
  assert (Rn : 0 < IZR n) by (apply IZR_lt; exact Hn).
  assert (Hk : (0 <= k)%Z) by (unfold k; lia).
  pose proof (real_aligned (- k) x ltac:(unfold k; lia)) as X. rewrite power_opp in X.
  assert (P : 0 < powerRZ 2 k) by (apply powerRZ_lt; lra).
  apply IZR_le in H. rewrite !mult_IZR, abs_IZR, minus_IZR, !mult_IZR, !two_power in H by lia.
  replace (powerRZ 2 49) with (2 ^ 49) in H by (change 49%Z with (Z.of_nat 49); rewrite pow_powerRZ; reflexivity).
  set (m := IZR (aligned (- k) x)) in *. set (p := powerRZ 2 k) in *. rewrite X.
  assert (T : 0 < 2 ^ 49) by (apply pow_lt; lra). set (t := 2 ^ 49) in *.
  replace (IZR e / IZR n - / p * m) with ((IZR e * p - IZR n * m) * / (IZR n * p)) by (field; lra).
  assert (NP : 0 < IZR n * p) by (apply Rmult_lt_0_compat; assumption).
  rewrite Rabs_mult, (Rabs_right (/ _)) by (left; apply Rinv_0_lt_compat; exact NP).
  apply Rmult_le_reg_r with (IZR n * p * t); [apply Rmult_lt_0_compat; assumption|].
  replace (Rabs (IZR e * p - IZR n * m) * / (IZR n * p) * (IZR n * p * t)) with (Rabs (IZR e * p - IZR n * m) * t)
    by (field; lra).
  replace (/ t * (IZR n * p * t)) with (IZR n * p) by (field; lra). exact H.
Qed.

Lemma quaternion_rotation a b c d n : n = a * a + b * b + c * c + d * d -> n <> 0 ->
  rotation (Mat (Vec ((a * a + b * b - c * c - d * d) / n) (2 * (b * c - a * d) / n) (2 * (b * d + a * c) / n))
                (Vec (2 * (b * c + a * d) / n) ((a * a - b * b + c * c - d * d) / n) (2 * (c * d - a * b) / n))
                (Vec (2 * (b * d - a * c) / n) (2 * (c * d + a * b) / n) ((a * a - b * b - c * c + d * d) / n))).
Proof.
  intros E N. unfold rotation, dot, cross, column1, column2, column3; cbn [vx vy vz row1 row2 row3].
  repeat split; subst n; field; exact N.
Qed.

Lemma has_rotation_ok p : has_rotation p = true -> exists M, pose_map p M.
Proof.
  unfold has_rotation. rewrite existsb_exists. intros (q & _ & H). unfold matrix_is_near in H.
  destruct q as [a b c d]. apply andb_true_iff in H. destruct H as [N H]. apply Z.ltb_lt in N.
  set (n := square (Quaternion a b c d)) in *.
  cbn [entries row_is_near] in H. rewrite !andb_true_iff in H.
  destruct H as [[[[H11 H12] H13] [[H21 H22] H23]] [[H31 H32] H33]].
  assert (Rn : IZR n = IZR a * IZR a + IZR b * IZR b + IZR c * IZR c + IZR d * IZR d)
    by (unfold n, square; cbn [qa qb qc qd]; rewrite !plus_IZR, !mult_IZR; reflexivity).
  assert (R0 : IZR n <> 0) by (apply not_0_IZR; lia).
  pose proof (quaternion_rotation (IZR a) (IZR b) (IZR c) (IZR d) (IZR n) Rn R0) as ROT.
  eexists. eapply pose_means. split; [exact ROT|]; repeat split; unfold point; cbn [vx vy vz row1 row2 row3];
    match goal with
    | |- Rabs (_ - real ?x) <= _ =>
        match goal with
        | H : is_near n ?e x = true |- _ =>
            apply is_near_ok in H; [|exact N]; eapply Rle_trans; [|exact H]; apply Req_le; f_equal; f_equal
        end
    end; unfold Rdiv; f_equal; rewrite ?mult_IZR, ?minus_IZR, ?plus_IZR, ?minus_IZR, ?plus_IZR, ?mult_IZR; ring.
Qed.

Lemma has_direction_ok a : has_direction a = true -> exists k, axis_means (point a) k.
Proof.
  unfold has_direction. rewrite negb_true_iff. intros H.
  assert (P : forall x, real x = 0 -> mantissa x = 0%Z).
  { intros x E. unfold real in E. apply Rmult_integral in E. destruct E as [E|E]; [apply eq_IZR; exact E|].
    assert (0 < powerRZ 2 (exponent x)) by (apply powerRZ_lt; lra). lra. }
  assert (D : 0 < dot (point a) (point a)).
  { unfold dot, point; cbn [vx vy vz]. destruct (Req_dec (real (n1 a)) 0) as [E1|]; [|nra].
    destruct (Req_dec (real (n2 a)) 0) as [E2|]; [|nra]. destruct (Req_dec (real (n3 a)) 0) as [E3|]; [|nra].
    rewrite (P _ E1), (P _ E2), (P _ E3) in H. discriminate. }
  assert (N : 0 < norm (point a)) by (apply sqrt_lt_R0; exact D).
  assert (S : norm (point a) * norm (point a) = dot (point a) (point a)) by (apply sqrt_sqrt; lra).
  exists (scale (/ norm (point a)) (point a)). split; [|split; [|reflexivity]].
  - replace (dot _ _) with (/ norm (point a) * / norm (point a) * dot (point a) (point a))
      by (unfold dot, scale; cbn [vx vy vz]; ring). rewrite <- S. field. lra.
  - assert (Z0 : 0 <= / 2 ^ 50) by (left; apply Rinv_0_lt_compat, pow_lt; lra).
    repeat split; unfold Rminus; rewrite Rplus_opp_r, Rabs_R0; exact Z0.
Qed.

Definition starts_exist (q : state) := forall v, exists S, start_map (start q v) S.

Lemma piece_means_ok p t : piece_means p = true -> starts_exist (at_time p t).
Proof.
  unfold piece_means, starts_exist, at_time, orientation; cbn [start]. intros H v.
  induction (orientations p) as [|[u [[a b] c]] os IH]; cbn [forallb find fst snd option_map] in *.
  - exists (fun x => x). intros x. reflexivity.
  - apply andb_true_iff in H. destruct H as [H1 H2]. destruct (Nat.eqb u v); [|exact (IH H2)].
    cbn [option_map snd start_map]. destruct (has_rotation_ok _ H1) as [M [m R]]. exists (apply m), m.
    split; [exact R | reflexivity].
Qed.

Lemma frame_means_ok w f q : tolerances_mean (off w) = true -> starts_exist q -> frame_means f = true ->
  exists O M, pose_map (origin f) O /\ elements_map w q (elements f) M M.
Proof.
  unfold tolerances_mean. rewrite !andb_true_iff. intros [[[[T1 T2] T3] _] _] HS.
  unfold frame_means. rewrite andb_true_iff. intros [H1 H2]. destruct (has_rotation_ok _ H1) as [O HO].
  exists O. induction (elements f) as [|e es IH].
  - exists (fun x => x). split; [exact HO | constructor].
  - cbn [forallb] in H2. apply andb_true_iff in H2. destruct H2 as [He Hes].
    destruct (IH Hes) as (M & _ & HM).
    assert (E : exists E, element_map w q e E E).
    { destruct e as [a v m c | a v m c | v]; cbn [element_means] in He.
      - destruct (has_direction_ok a He) as [k Hk]. pose proof (most_not_below_0 _ v T1) as T.
        exists (turn k (real m * amount q v + real c)).
        pose proof (turn_map w q a k v m c 0 Hk ltac:(rewrite Rabs_R0; exact T)) as K. rewrite Rplus_0_r in K. exact K.
      - destruct (has_direction_ok a He) as [k Hk]. pose proof (most_not_below_0 _ v T1) as T. pose proof (most_not_below_0 _ v T2) as L.
        exists (fun x => add x (scale (real m * amount q v + real c) k)).
        pose proof (slide_map w q a k v m c 0 (Vec 0 0 0) Hk ltac:(rewrite Rabs_R0; exact T)
          ltac:(rewrite norm_zero; apply Rmult_le_pos; [apply Rabs_pos | exact L])) as K. rewrite Rplus_0_r in K.
        eapply eq_ind; [exact K|]. extensionality x. destruct x, k. coords. f_equal; ring.
      - destruct (HS v) as [S Sv]. pose proof (most_not_below_0 _ v T3) as T.
        exists (fun x => rotate (Vec (amount q v) (amount q (v + 1)) (amount q (v + 2))) (S x)).
        exact (rotate_map w q v S (fun x => x) Sv (no_turn _ T)). }
    destruct E as [E HE]. exists (fun x => E (M x)). split; [exact HO | apply first_element; assumption].
Qed.

(** Frames are placed one after the other: each stands in one that has its place already. *)
Lemma frames_exist w q : tolerances_mean (off w) = true -> starts_exist q ->
  (forall i f, nth_error (frames w) i = Some f -> (parent f <= i)%nat) ->
  forallb frame_means (frames w) = true -> exists P, frames_at w q P P.
Proof.
  intros HT HS WF H. rewrite forallb_forall in H.
  assert (K : forall n, exists P : nat -> vec -> vec, (forall x, P O x = x) /\
    forall i f, (i < n)%nat -> nth_error (frames w) i = Some f ->
      exists O M, pose_map (origin f) O /\ elements_map w q (elements f) M M /\ forall x, P (S i) x = P (parent f) (O (M x))).
  { induction n as [|n (P & P0 & PS)].
    - exists (fun _ x => x). split; [reflexivity | intros; lia].
    - destruct (nth_error (frames w) n) as [f|] eqn:N.
      + destruct (frame_means_ok w f q HT HS (H f (nth_error_In _ _ N))) as (O & M & HO & HM).
        exists (fun j x => if Nat.eqb j (S n) then P (parent f) (O (M x)) else P j x). split; [exact P0|].
        intros i g Hi Ng. pose proof (WF i g Ng) as Wg.
        destruct (Nat.eq_dec i n) as [->|D].
        * rewrite N in Ng. injection Ng as <-. exists O, M. split; [exact HO|]. split; [exact HM|]. intros x.
          rewrite Nat.eqb_refl. destruct (Nat.eqb_spec (parent f) (S n)); [lia | reflexivity].
        * destruct (PS i g ltac:(lia) Ng) as (O' & M' & HO' & HM' & X). exists O', M'.
          split; [exact HO'|]. split; [exact HM'|]. intros x.
          destruct (Nat.eqb_spec (S i) (S n)); [lia|]. destruct (Nat.eqb_spec (parent g) (S n)); [lia|]. apply X.
      + exists P. split; [exact P0|]. intros i f Hi Nf. apply PS; [|exact Nf].
        assert (i <> n) by (intros ->; congruence). lia. }
  destruct (K (length (frames w))) as (P & P0 & PS). exists P. split; [exact P0|]. split; [exact P0|]. intros i f N.
  destruct (PS i f ltac:(apply nth_error_Some; congruence) N) as (O & M & HO & HM & X).
  exists O, (fun x => x), M, M. split; [exact HO|]. split; [|auto].
  apply not_off. intros t. apply tolerance_found. unfold tolerances_mean in HT. rewrite !andb_true_iff in HT. apply HT.
Qed.
